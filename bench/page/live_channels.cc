// SPDX-License-Identifier: Apache-2.0
#include "bench/page/live_channels.h"

#include <string>

#include "bench/campaign/live_readings.h"

namespace strainwave::bench {
namespace {

using nlohmann::json;

// As the bins have them, which are of single precision: its digits and no more.
json Shown(double value_si, double per_si) { return static_cast<float>(value_si * per_si); }

json EnvelopeJson(const Envelope& envelope) {
  json starts = json::array();
  for (std::size_t bin = 0; bin < envelope.bins().size(); ++bin) {
    starts.push_back(envelope.start_s() + static_cast<double>(bin) * envelope.width_s());
  }
  json all{{"bin_s", envelope.width_s()}, {"bench_time_s", std::move(starts)}};
  for (std::size_t channel = 0; channel < kLiveQuantities.size(); ++channel) {
    const LiveQuantity& quantity = kLiveQuantities[channel];
    json& of_quantity = all[std::string(quantity.name)] = {
        {"min", json::array()}, {"max", json::array()}, {"last", json::array()}};
    for (const LiveExtremes& bin : envelope.bins()) {
      const Extremes& values = bin.channels[channel];
      const auto put = [&](const char* what, double value) {
        of_quantity[what].push_back(values.empty() ? json() : Shown(value, quantity.per_si));
      };
      put("min", values.min);
      put("max", values.max);
      put("last", values.last);
    }
  }
  return all;
}

}  // namespace

nlohmann::json LiveChannelsJson(const std::optional<LiveEnvelopes>& envelopes, const Moment& now) {
  json quantities = json::array();
  for (const LiveQuantity& quantity : kLiveQuantities) {
    quantities.push_back({{"quantity", quantity.name}, {"unit", quantity.unit}});
  }
  json answer{
      {"quantities", std::move(quantities)}, {"age_s", nullptr}, {"recent", nullptr}, {"whole", nullptr}};
  if (!envelopes) return answer;
  if (const auto age_s = PauseBetween(envelopes->taken, now).length_s) answer["age_s"] = *age_s;
  answer["recent"] = EnvelopeJson(envelopes->recent);
  answer["whole"] = EnvelopeJson(envelopes->whole);
  return answer;
}

}  // namespace strainwave::bench

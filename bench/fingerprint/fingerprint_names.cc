// SPDX-License-Identifier: Apache-2.0
#include "bench/fingerprint/fingerprint_names.h"

#include <initializer_list>
#include <stdexcept>

#include <fmt/format.h>

namespace strainwave::bench {
namespace {

using analysis::joint_dynamics::Fingerprint, analysis::joint_dynamics::Method;

template <typename Enum>
Enum ByName(const std::string& name, std::initializer_list<Enum> all) {
  for (const Enum value : all) {
    if (name == NameOf(value)) return value;
  }
  throw std::invalid_argument(fmt::format("'{}' is not known", name));
}

}  // namespace

Fingerprint FingerprintKindNamed(const std::string& name) {
  return ByName(name, {Fingerprint::kJoint, Fingerprint::kGroup, Fingerprint::kTensor});
}

Method AttributionMethodNamed(const std::string& name) {
  return ByName(name, {Method::kExact, Method::kKernel, Method::kGradients});
}

}  // namespace strainwave::bench

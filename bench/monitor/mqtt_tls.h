// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/monitor/settings.h"

struct mosquitto;

namespace strainwave::bench {

/// Reads the certificates that the settings name: the authority's, the monitor's own and its key.
/// @throws CampaignError naming the file that holds none, the one that is not valid yet or no longer, or the
/// key
///   that is not the certificate's.
void RequireUsable(const TlsSettings& tls);

/// Has a client encrypt its connection and check the broker's certificate and name.
/// @throws CampaignError if libmosquitto does not take the files.
void UseTls(mosquitto* client, const TlsSettings& tls);

/// Why an encrypted connection failed, for whoever has to mend it.
/// @param said  the errors that libmosquitto has logged, a line each.
std::string WhyTlsFailed(mosquitto* client, const MqttSettings& settings, const std::string& said);

}  // namespace strainwave::bench

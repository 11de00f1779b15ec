// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "bench/monitor/settings.h"

struct mosquitto;
struct ssl_ctx_st;
struct ssl_st;

namespace strainwave::bench {

/// Reads the certificates that the settings name: the authority's, the monitor's own and its key.
/// @throws BenchError naming the file that holds none, the one that is not valid yet or no longer, or
///   the key that is not the certificate's.
void RequireUsable(const TlsSettings& tls);

/// A client's encryption, and what its handshake comes to. OpenSSL tells that as it happens: by the time
/// libmosquitto reports a failure it may have thrown away the connection's state, and with it the reason.
class TlsHandshake {
 public:
  /// Has a client encrypt its connection and check the broker's certificate and name.
  /// @param client  does not outlive this.
  /// @throws BenchError naming a file that cannot be used.
  TlsHandshake(mosquitto* client, const MqttSettings& settings);
  TlsHandshake(const TlsHandshake&) = delete;
  TlsHandshake& operator=(const TlsHandshake&) = delete;
  ~TlsHandshake() = default;

  /// Why a connection failed before the broker answered, for whoever has to mend it; empty where that has
  /// nothing to do with TLS.
  /// @param said  the errors that libmosquitto has logged, a line each.
  std::string WhyFailed(const std::string& said) const;

 private:
  static void Note(const ssl_st* connection, int where, int value);

  const MqttSettings& settings_;
  std::unique_ptr<ssl_ctx_st, void (*)(ssl_ctx_st*)> context_;
  long verdict_{};     // of the broker's certificate, as SSL_get_verify_result
  std::string alert_;  // the broker's last objection
  bool done_{};        // on this side; the broker may still refuse
};

}  // namespace strainwave::bench

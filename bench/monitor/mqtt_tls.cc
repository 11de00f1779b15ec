// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/mqtt_tls.h"

#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <mosquitto.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include "bench/campaign/campaign_error.h"

namespace strainwave::bench {
namespace {

template <auto Release>
struct Free {
  void operator()(auto* object) const { Release(object); }
};
using Certificate = std::unique_ptr<X509, Free<&X509_free>>;
using Key = std::unique_ptr<EVP_PKEY, Free<&EVP_PKEY_free>>;
using File = std::unique_ptr<std::FILE, Free<&std::fclose>>;

File Open(const std::filesystem::path& path) {
  File file(std::fopen(path.c_str(), "rbe"));
  if (!file) Refuse(path, "cannot be read", "a file in PEM format");
  return file;
}

std::string TextOf(const ASN1_TIME* time) {
  std::tm parts{};
  if (ASN1_TIME_to_tm(time, &parts) != 1) return "a time that cannot be read";
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02} UTC", parts.tm_year + 1900, parts.tm_mon + 1,
                     parts.tm_mday, parts.tm_hour, parts.tm_min);
}

std::string LastLine(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  const std::size_t end = text.rfind('\n');
  return end == std::string::npos ? text : text.substr(end + 1);
}

Certificate ValidCertificate(const std::filesystem::path& path) {
  const File file = Open(path);
  Certificate certificate(PEM_read_X509(file.get(), nullptr, nullptr, nullptr));
  if (!certificate) Refuse(path, "holds no certificate", "one in PEM format, -----BEGIN CERTIFICATE-----");
  const ASN1_TIME* const from = X509_get0_notBefore(certificate.get());
  const ASN1_TIME* const until = X509_get0_notAfter(certificate.get());
  if (X509_cmp_current_time(until) < 0) {
    Refuse(path, fmt::format("the certificate expired at {}", TextOf(until)), "one that is valid now");
  }
  if (X509_cmp_current_time(from) > 0) {
    Refuse(path, fmt::format("the certificate is not valid before {}", TextOf(from)),
           "one that is valid now, and a clock that is right");
  }
  return certificate;
}

}  // namespace

void RequireUsable(const TlsSettings& tls) {
  if (!tls.used()) return;
  ValidCertificate(tls.ca_file);
  if (tls.certificate_file.empty()) return;
  const Certificate own = ValidCertificate(tls.certificate_file);
  const File file = Open(tls.key_file);
  // A passphrase cannot be asked for; an empty one opens nothing that has one.
  const Key key(PEM_read_PrivateKey(
      file.get(), nullptr, [](char*, int, int, void*) { return 0; }, nullptr));
  if (!key) Refuse(tls.key_file, "holds no key that can be read", "one in PEM format without a passphrase");
  if (X509_check_private_key(own.get(), key.get()) != 1) {
    Refuse(tls.key_file, "is not the key of " + tls.certificate_file.string(), "the key that belongs to it");
  }
}

void UseTls(mosquitto* client, const TlsSettings& tls) {
  const bool has_own = !tls.certificate_file.empty();
  const int code = mosquitto_tls_set(client, tls.ca_file.c_str(), nullptr,
                                     has_own ? tls.certificate_file.c_str() : nullptr,
                                     has_own ? tls.key_file.c_str() : nullptr, nullptr);
  if (code != MOSQ_ERR_SUCCESS) Refuse(tls.ca_file, mosquitto_strerror(code), "certificates for TLS");
}

std::string WhyTlsFailed(mosquitto* client, const MqttSettings& settings, const std::string& said) {
  if (said.find("host name verification failed") != std::string::npos) {
    return fmt::format("the broker's certificate is not for {} (expected that name in it)", settings.host);
  }
  const auto* const ssl = static_cast<const SSL*>(mosquitto_ssl_get(client));
  const long verdict = ssl == nullptr ? X509_V_OK : SSL_get_verify_result(ssl);
  if (verdict != X509_V_OK) {
    return fmt::format(
        "the broker's certificate is not accepted: {} (expected one that is valid now and signed by {})",
        X509_verify_cert_error_string(verdict), settings.tls.ca_file.string());
  }
  // The broker's own objection comes as an alert: "tlsv13 alert certificate required".
  const std::string last = LastLine(said);
  const std::size_t alert = last.find("alert");
  if (alert != std::string::npos) {
    return fmt::format(
        "the broker refuses the connection: {} (expected certificate_file to be one that it accepts)",
        last.substr(alert));
  }
  return fmt::format("no encrypted connection: {} (expected a broker that speaks TLS on port {})",
                     last.empty() ? "the handshake failed" : last, settings.port);
}

}  // namespace strainwave::bench

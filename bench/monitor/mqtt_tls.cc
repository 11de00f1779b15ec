// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/mqtt_tls.h"

#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <mosquitto.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include "bench/errors/bench_error.h"

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

// The context is set up here and not by libmosquitto, whose own check of the certificate finds nothing to
// check against in a context that it has not made.
TlsHandshake::TlsHandshake(mosquitto* client, const MqttSettings& settings)
    : settings_(settings), context_(SSL_CTX_new(TLS_client_method()), SSL_CTX_free) {
  SSL_CTX* const context = context_.get();
  const TlsSettings& tls = settings.tls;
  const auto demand = [](bool done, const std::filesystem::path& file) {
    if (!done) Refuse(file, "cannot be used for TLS", "a file in PEM format");
  };
  SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION);
  SSL_CTX_set_app_data(context, this);
  SSL_CTX_set_info_callback(context, &TlsHandshake::Note);
  demand(SSL_CTX_load_verify_locations(context, tls.ca_file.c_str(), nullptr) == 1, tls.ca_file);
  SSL_CTX_set_verify(context, SSL_VERIFY_PEER, nullptr);
  X509_VERIFY_PARAM* const wanted = SSL_CTX_get0_param(context);
  const char* const host = settings.host.c_str();
  if (X509_VERIFY_PARAM_set1_ip_asc(wanted, host) != 1) X509_VERIFY_PARAM_set1_host(wanted, host, 0);
  if (!tls.certificate_file.empty()) {
    demand(SSL_CTX_use_certificate_chain_file(context, tls.certificate_file.c_str()) == 1,
           tls.certificate_file);
    demand(SSL_CTX_use_PrivateKey_file(context, tls.key_file.c_str(), SSL_FILETYPE_PEM) == 1, tls.key_file);
  }
  mosquitto_void_option(client, MOSQ_OPT_SSL_CTX, context);
  mosquitto_int_option(client, MOSQ_OPT_SSL_CTX_WITH_DEFAULTS, 0);
}

void TlsHandshake::Note(const SSL* connection, int where, int value) {
  auto* const self = static_cast<TlsHandshake*>(SSL_CTX_get_app_data(SSL_get_SSL_CTX(connection)));
  constexpr int kCloseNotify = 0;
  const int alert = value & 0xFF;
  if ((where & SSL_CB_READ_ALERT) == SSL_CB_READ_ALERT && alert != kCloseNotify) {
    // OpenSSL 3.0 has no words for this one, the first that a certificate left out brings about.
    self->alert_ =
        alert == SSL_AD_CERTIFICATE_REQUIRED ? "certificate required" : SSL_alert_desc_string_long(value);
  }
  self->verdict_ = SSL_get_verify_result(connection);
  self->done_ = self->done_ || (where & SSL_CB_HANDSHAKE_DONE) != 0;
}

std::string TlsHandshake::WhyFailed(const std::string& said) const {
  constexpr const char* kOwn = "expected certificate_file to be one that it accepts";
  if (verdict_ == X509_V_ERR_HOSTNAME_MISMATCH || verdict_ == X509_V_ERR_IP_ADDRESS_MISMATCH) {
    return fmt::format("the broker's certificate is not for {} (expected that name in it)", settings_.host);
  }
  if (verdict_ != X509_V_OK) {
    return fmt::format(
        "the broker's certificate is not accepted: {} (expected one that is valid now and signed by {})",
        X509_verify_cert_error_string(verdict_), settings_.tls.ca_file.string());
  }
  if (!alert_.empty()) return fmt::format("the broker refuses the connection: {} ({})", alert_, kOwn);
  // In TLS 1.3 the broker looks at the certificate after this side is done; what it objects is lost where the
  // connection is gone before it is read.
  if (done_) return fmt::format("the broker closed the connection without an answer ({})", kOwn);
  if (said.empty()) return {};
  return fmt::format("no encrypted connection: {} (expected a broker that speaks TLS on port {})",
                     LastLine(said), settings_.port);
}

}  // namespace strainwave::bench

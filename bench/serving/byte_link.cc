// SPDX-License-Identifier: Apache-2.0
#include "bench/serving/byte_link.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <new>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

namespace strainwave::bench {
namespace {

class Plain : public ByteLink {
 public:
  explicit Plain(int socket) : socket_(socket) {}

  ssize_t Read(char* bytes, std::size_t most) override { return ::recv(socket_, bytes, most, 0); }
  ssize_t Write(std::string_view bytes) override {
    return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  void EndWriting() override { ::shutdown(socket_, SHUT_WR); }

 private:
  int socket_;
};

struct FreeSsl {
  void operator()(SSL* ssl) const { ::SSL_free(ssl); }
};

// The handshake is done by the first reads.
class Tls : public ByteLink {
 public:
  Tls(SSL_CTX* context, int socket) : socket_(socket), ssl_(::SSL_new(context)) {
    if (!ssl_ || ::SSL_set_fd(ssl_.get(), socket) != 1) throw std::bad_alloc();
    ::SSL_set_accept_state(ssl_.get());
  }

  ssize_t Read(char* bytes, std::size_t most) override {
    return Outcome(::SSL_read(ssl_.get(), bytes, Length(most)));
  }
  ssize_t Write(std::string_view bytes) override {
    return Outcome(::SSL_write(ssl_.get(), bytes.data(), Length(bytes.size())));
  }
  void EndWriting() override {
    ::ERR_clear_error();
    ::SSL_shutdown(ssl_.get());
    ::shutdown(socket_, SHUT_WR);
  }
  bool HasMore() const override { return ::SSL_pending(ssl_.get()) > 0; }
  short Waits() const override { return waits_; }

 private:
  static int Length(std::size_t count) { return static_cast<int>(std::min<std::size_t>(count, INT_MAX)); }

  ssize_t Outcome(int count) {
    waits_ = 0;
    if (count > 0) return count;
    const int error = ::SSL_get_error(ssl_.get(), count);
    ::ERR_clear_error();  // of this thread, which has other connections
    if (error == SSL_ERROR_ZERO_RETURN) return 0;
    if (error == SSL_ERROR_WANT_READ || error == SSL_ERROR_WANT_WRITE) {
      waits_ = error == SSL_ERROR_WANT_READ ? POLLIN : POLLOUT;
      errno = EAGAIN;
    } else {
      errno = ECONNABORTED;
    }
    return -1;
  }

  int socket_;
  std::unique_ptr<SSL, FreeSsl> ssl_;
  short waits_{};
};

std::string LastError() {
  const unsigned long error = ::ERR_peek_last_error();
  ::ERR_clear_error();
  const char* const reason = ::ERR_reason_error_string(error);
  return reason == nullptr ? "not readable" : reason;
}

}  // namespace

std::unique_ptr<ByteLink> PlainLink(int socket) { return std::make_unique<Plain>(socket); }

class TlsIdentity::Impl {
 public:
  Impl() : context_(::SSL_CTX_new(::TLS_server_method())) {
    if (context_ == nullptr) throw std::bad_alloc();
    ::SSL_CTX_set_min_proto_version(context_, TLS1_2_VERSION);
    // What was not taken whole may be offered again from another place, with more behind it.
    ::SSL_CTX_set_mode(context_, SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
    ::SSL_CTX_set_options(context_, SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() { ::SSL_CTX_free(context_); }

  SSL_CTX* context() const { return context_; }

 private:
  SSL_CTX* context_;
};

TlsIdentity::TlsIdentity(const std::filesystem::path& certificate, const std::filesystem::path& key)
    : impl_(std::make_unique<Impl>()) {
  if (::SSL_CTX_use_certificate_chain_file(impl_->context(), certificate.c_str()) != 1) {
    throw std::runtime_error(
        fmt::format("{}: error: no certificate: {} (expected a PEM file with the "
                    "certificate of this machine)",
                    certificate.string(), LastError()));
  }
  if (::SSL_CTX_use_PrivateKey_file(impl_->context(), key.c_str(), SSL_FILETYPE_PEM) != 1) {
    throw std::runtime_error(
        fmt::format("{}: error: not the key of that certificate: {} (expected a PEM file "
                    "with its private key, without a passphrase)",
                    key.string(), LastError()));
  }
}

TlsIdentity::~TlsIdentity() = default;

std::unique_ptr<ByteLink> TlsIdentity::Link(int socket) const {
  return std::make_unique<Tls>(impl_->context(), socket);
}

}  // namespace strainwave::bench

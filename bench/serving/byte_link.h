// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string_view>

namespace strainwave::bench {

/// How the bytes of one client go over a socket that does not wait. Reads and writes answer as recv and send
/// do: how many, 0 at the end, −1 with errno, EAGAIN where it is to be tried again.
class ByteLink {
 public:
  ByteLink() = default;
  ByteLink(const ByteLink&) = delete;
  ByteLink& operator=(const ByteLink&) = delete;
  virtual ~ByteLink() = default;

  virtual ssize_t Read(char* bytes, std::size_t most) = 0;
  virtual ssize_t Write(std::string_view bytes) = 0;
  /// Nothing more will be written.
  virtual void EndWriting() = 0;
  /// Whether there is something to read that the socket does not know of.
  virtual bool HasMore() const { return false; }
  /// What the socket must be ready for before the last call goes on, as poll has it; 0: nothing of its own.
  virtual short Waits() const { return 0; }
};

std::unique_ptr<ByteLink> PlainLink(int socket);

/// A server's certificate and key, for connections by TLS 1.2 or later.
class TlsIdentity {
 public:
  /// @param certificate  PEM, with what leads to its root; @param key  PEM, without a passphrase.
  /// @throws std::runtime_error with what is wrong with which file, and what was expected.
  TlsIdentity(const std::filesystem::path& certificate, const std::filesystem::path& key);
  TlsIdentity(const TlsIdentity&) = delete;
  TlsIdentity& operator=(const TlsIdentity&) = delete;
  ~TlsIdentity();

  std::unique_ptr<ByteLink> Link(int socket) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace strainwave::bench

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/campaign/folder.h"
#include "bench/serving/tcp_server.h"

namespace strainwave::bench {

struct PageSettings {
  CampaignFolder folder;
  std::string address{"127.0.0.1"};  // another than of the loopback: who looks on must be logged in
  std::vector<std::string> names{};  // of this machine, by which others reach that address
  int port{};                        // 0: any free one
  std::optional<std::filesystem::path> users_file;  // who may do more than look on and stop; nothing: nobody
  std::filesystem::path predictor{};                // of the newest cycle; empty: none
  std::filesystem::path baseline{};                 // of a predictor of changes; else empty
  const TlsIdentity* tls{};                         // outlives the page; nothing: not encrypted
  /// Takes what could not be kept and nobody waits for, a sentence each, from any thread.
  std::function<void(const std::string&)> complain;
};

/// The live page of a campaign: serves it from threads of its own, as long as it lives, and only reads the
/// campaign's folder. One thread carries all connections and answers whatever needs no disk; one watches the
/// campaign; one reads cycles; one predicts. So nothing that viewers do keeps a quick stop waiting
/// (docs/decisions/0017-live-page.md).
class PageServer {
 public:
  /// @throws std::system_error when it cannot listen there; as OpenCampaign, when the folder is no campaign;
  ///   UsersFileError; BenchError for a predictor that cannot be used.
  explicit PageServer(const PageSettings& settings);
  ~PageServer();

  int port() const;

 private:
  class Pages;
  std::unique_ptr<Pages> pages_;
  std::unique_ptr<TcpServer> server_;
};

}  // namespace strainwave::bench

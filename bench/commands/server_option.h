// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "bench/central/fetched_campaign.h"

namespace strainwave::bench {

/// --server, as libpq takes it. @param conninfo  outlives the command.
CLI::Option* AddServerOption(CLI::App& command, std::string& conninfo);
CLI::Option* AddQueryOption(CLI::App& command, std::string& query);

/// Campaigns that are asked for at a server in place of folders.
struct FromServer {
  std::string conninfo;  // empty: from folders
  std::string query;
  std::string store;
};

/// --from-server, --query and --store of a command that otherwise takes `folders`. @param from  outlives the
/// command.
void AddFromServer(CLI::App& command, FromServer& from, CLI::Option* folders);

enum class Copies { kFetched, kLeftOut };  // of campaigns that several benches have forwarded

/// Writes the folders that were asked for below `into`, and tells what is uncertain about each.
/// @param warnings  takes what was told.
/// @throws BenchError (exit code 2) where no campaign is found; as FetchCampaign.
std::vector<FetchedCampaign> FetchFromServer(const FromServer& from, const std::filesystem::path& into,
                                             Copies copies, std::vector<std::string>& warnings);

/// The folders that a command is to read: those given, or those of a server, each campaign once, which are
/// gone when this is.
class CampaignFolders {
 public:
  /// @throws BenchError (exit code 2) where neither is given; as FetchFromServer.
  CampaignFolders(const std::vector<std::string>& given, const FromServer& from);
  CampaignFolders(const CampaignFolders&) = delete;
  CampaignFolders& operator=(const CampaignFolders&) = delete;
  ~CampaignFolders();

  const std::vector<std::string>& paths() const { return paths_; }
  /// What was told of those of a server.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  std::filesystem::path made_;
  std::vector<std::string> paths_;
  std::vector<std::string> warnings_;
};

}  // namespace strainwave::bench

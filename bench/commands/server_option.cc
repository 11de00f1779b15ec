// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/server_option.h"

#include <cerrno>
#include <cstdlib>
#include <system_error>

#include <fmt/core.h>

#include "bench/central/campaign_query.h"
#include "bench/central/record_store.h"
#include "bench/central/schema.h"
#include "bench/commands/no_core.h"
#include "bench/commands/output.h"

namespace strainwave::bench {
namespace {

constexpr const char* kConninfoWords =
    "PostgreSQL, as libpq takes it: 'host=HOST dbname=NAME user=ROLE', a URI, or service=NAME; without a "
    "password";

std::filesystem::path NewTemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "strainwave-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::system_error(errno, std::generic_category(), name);
  return name;
}

}  // namespace

CLI::Option* AddServerOption(CLI::App& command, std::string& conninfo) {
  return command.add_option("--server", conninfo, kConninfoWords)->type_name("CONNINFO")->required();
}

CLI::Option* AddQueryOption(CLI::App& command, std::string& query) {
  return command
      .add_option(
          "--query", query,
          "which campaigns: bench=, specimen=, schedule=, campaign=, with '*' and '?' in a value and commas "
          "between several; all conditions hold (default: all campaigns)")
      ->type_name("CONDITIONS");
}

void AddFromServer(CLI::App& command, FromServer& from, CLI::Option* folders) {
  CLI::Option* const server =
      command
          .add_option("--from-server", from.conninfo,
                      "campaigns of this server in place of folders; " + std::string(kConninfoWords))
          ->type_name("CONNINFO")
          ->excludes(folders);
  AddQueryOption(command, from.query)->needs(server);
  command
      .add_option("--store", from.store,
                  "folder of their raw records, which central forward --store has filled")
      ->needs(server);
}

std::vector<FetchedCampaign> FetchFromServer(const FromServer& from, const std::filesystem::path& into,
                                             Copies copies, std::vector<std::string>& warnings) {
  LeaveNoCore();
  const auto tell = [&](const std::string& warning) {
    warnings.push_back(warning);
    ToStderr("warning: {}\n", warning);
  };
  DemandFetchPlace(into, {});
  CheckConninfo(from.conninfo);
  const CampaignQuery query = ParseCampaignQuery(from.query);
  if (!from.store.empty() && !std::filesystem::is_directory(from.store))
    Refuse(from.store, "is no folder", "the store that central forward --store has filled");
  Server server(from.conninfo);
  DemandSchema(server);
  std::vector<FoundCampaign> found = FindCampaigns(server, query);
  if (found.empty()) {
    Refuse("--query", fmt::format("the server has no campaign of '{}'", from.query),
           "some; strainwave central list shows all");
  }
  for (const FoundCampaign& one : found) {
    if (copies == Copies::kLeftOut && !one.same_as.empty())
      tell(fmt::format("{}: is the campaign {} again, forwarded by another bench: left out", one.Name(),
                       one.same_as));
  }
  if (copies == Copies::kLeftOut)
    std::erase_if(found, [](const FoundCampaign& one) { return !one.same_as.empty(); });
  DemandFetchPlace(into, found);
  std::optional<RecordStore> store;
  if (!from.store.empty()) store.emplace(from.store);
  std::vector<FetchedCampaign> fetched;
  for (const FoundCampaign& one : found) {
    fetched.push_back(FetchCampaign(server, one, into, store ? &*store : nullptr));
    for (const std::string& warning : fetched.back().warnings)
      tell(fmt::format("{}: {}", one.Name(), warning));
  }
  return fetched;
}

CampaignFolders::CampaignFolders(const std::vector<std::string>& given, const FromServer& from)
    : paths_(given) {
  if (from.conninfo.empty()) {
    if (given.empty()) Refuse("the command line", "names no campaign", "its folder, or --from-server");
    return;
  }
  made_ = NewTemporaryFolder();
  try {
    for (const FetchedCampaign& one : FetchFromServer(from, made_, Copies::kLeftOut, warnings_))
      paths_.push_back(one.folder.string());
  } catch (...) {
    std::error_code gone;
    std::filesystem::remove_all(made_, gone);
    throw;
  }
}

CampaignFolders::~CampaignFolders() {
  std::error_code gone;
  if (!made_.empty()) std::filesystem::remove_all(made_, gone);
}

}  // namespace strainwave::bench

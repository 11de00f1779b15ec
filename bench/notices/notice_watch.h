// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/campaign/folder.h"
#include "bench/notices/notice_file.h"
#include "bench/notices/notice_post.h"
#include "bench/notices/notice_settings.h"
#include "bench/page/campaign_watch.h"
#include "daq/file_descriptor.h"

namespace strainwave::bench {

/// One look after the other at a campaign that another process runs, or nobody.
class NoticeLooks {
 public:
  /// @throws as OpenCampaign, unless `even_unreadable`: then it is a view as any other.
  NoticeLooks(const CampaignFolder& folder, bool even_unreadable);

  NoticeView Look(const Moment& now);

 private:
  CampaignFolder folder_;
  std::unique_ptr<CampaignWatch> watch_;  // none: the folder could not be read yet
  std::string trouble_;
};

/// Watches a campaign and sends notices. Of the campaign it only reads; its own file lies beside. One watch a
/// campaign.
class NoticeWatch {
 public:
  using Log = std::function<void(const std::string& line)>;

  /// @param given_up  whether to leave off; asked from any thread
  /// @param log  called from the thread of the calls below
  /// @throws as OpenCampaign where the campaign was never watched before; BenchError where it is watched
  ///   already.
  NoticeWatch(const CampaignFolder& folder, const NoticeSettings& settings, const GivenUp& given_up, Log log);

  /// A look once a second, and a part of a second of waiting for what comes of notices.
  void Round();
  /// One look, and every channel has a try at what waits for it. @return whether nothing waits any more.
  bool Once();

 private:
  void LookAndPlan();
  void Hand();
  void Take(std::chrono::milliseconds patience);
  void Keep();

  CampaignFolder folder_;
  std::filesystem::path file_;
  NoticeRules rules_;
  GivenUp given_up_;
  Log log_;
  NoticeLooks looks_;
  daq::FileDescriptor lock_;  // taken once the folder is known to be a campaign's
  NoticeState state_;
  std::string kept_;          // as it is in the file
  std::string keep_trouble_;  // why that could not be written
  std::optional<std::chrono::steady_clock::time_point> looked_;
  NoticePost post_;
};

}  // namespace strainwave::bench

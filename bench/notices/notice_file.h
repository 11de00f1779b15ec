// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "bench/campaign/folder.h"
#include "bench/notices/notice_outbox.h"
#include "daq/file_descriptor.h"

namespace strainwave::bench {

/// `notices.json` in the campaign's folder: what was sent and what waits, written whole or not at all.
std::filesystem::path NoticeFileOf(const CampaignFolder& folder);

nlohmann::json NoticeStateJson(const NoticeState& state);
/// What NoticeStateJson has made. @throws std::exception for anything else.
NoticeState NoticeStateFrom(const nlohmann::json& json);

/// Nothing is kept where there is no file yet.
/// @param trouble  why a file that is there cannot be used, as after a power cut on a disk that lies; what
///   was sent is told anew then. Else empty.
NoticeState ReadNoticeFile(const std::filesystem::path& file, std::string& trouble);
/// @throws daq::DataFileError.
void WriteNoticeFile(const std::filesystem::path& file, const NoticeState& state);

/// Held by the one watch of a campaign, in `notices.lock`; the kernel lets go when the process ends.
/// @throws BenchError when another one has it; std::system_error where the folder takes no file.
daq::FileDescriptor HoldNotices(const CampaignFolder& folder);

}  // namespace strainwave::bench

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <curl/curl.h>

#include "bench/notices/notice_sender.h"

namespace strainwave::bench {

struct CurlListFree {
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};
using CurlList = std::unique_ptr<curl_slist, CurlListFree>;
void Append(CurlList& list, const std::string& line);

/// One transfer of libcurl with what all of them need: time limits, no signals, certificates that are looked
/// at, an end when it is asked for.
class CurlTransfer {
 public:
  CurlTransfer(const GivenUp& given_up, const std::filesystem::path& ca_file);

  CURL* handle() const { return handle_.get(); }
  /// @return why it did not work; empty: it did.
  std::string Perform();

 private:
  struct Cleanup {
    void operator()(CURL* handle) const { curl_easy_cleanup(handle); }
  };

  const GivenUp& given_up_;
  std::unique_ptr<CURL, Cleanup> handle_;
};

}  // namespace strainwave::bench

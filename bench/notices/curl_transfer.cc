// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/curl_transfer.h"

#include <array>
#include <new>

#include <fmt/format.h>

#include "bench/escaped.h"

namespace strainwave::bench {
namespace {

struct CurlLibrary {
  CurlLibrary() { curl_global_init(CURL_GLOBAL_DEFAULT); }
  CurlLibrary(const CurlLibrary&) = delete;
  CurlLibrary& operator=(const CurlLibrary&) = delete;
  ~CurlLibrary() { curl_global_cleanup(); }
};

int AbortWhenGivenUp(void* given_up, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return (*static_cast<const GivenUp*>(given_up))() ? 1 : 0;
}

std::size_t DropAnswer(char*, std::size_t size, std::size_t count, void*) { return size * count; }

}  // namespace

void Append(CurlList& list, const std::string& line) {
  curl_slist* const longer = curl_slist_append(list.get(), line.c_str());
  if (longer == nullptr) throw std::bad_alloc();
  static_cast<void>(list.release());
  list.reset(longer);
}

CurlTransfer::CurlTransfer(const GivenUp& given_up, const std::filesystem::path& ca_file)
    : given_up_(given_up) {
  static const CurlLibrary library;
  handle_.reset(curl_easy_init());
  if (!handle_) throw std::bad_alloc();
  CURL* const curl = handle();
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT, static_cast<long>(kConnectTimeout_s));
  curl_easy_setopt(curl, CURLOPT_TIMEOUT, static_cast<long>(kSendTimeout_s));
  curl_easy_setopt(curl, CURLOPT_SSLVERSION, static_cast<long>(CURL_SSLVERSION_TLSv1_2));
  curl_easy_setopt(curl, CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(curl, CURLOPT_XFERINFOFUNCTION, &AbortWhenGivenUp);
  curl_easy_setopt(curl, CURLOPT_XFERINFODATA, const_cast<GivenUp*>(&given_up_));
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, &DropAnswer);
  if (!ca_file.empty()) curl_easy_setopt(curl, CURLOPT_CAINFO, ca_file.c_str());
}

std::string CurlTransfer::Perform() {
  std::array<char, CURL_ERROR_SIZE> words{};
  curl_easy_setopt(handle(), CURLOPT_ERRORBUFFER, words.data());
  const CURLcode code = curl_easy_perform(handle());
  curl_easy_setopt(handle(), CURLOPT_ERRORBUFFER, nullptr);
  if (code == CURLE_OK) return {};
  // The other end's answer may be in the words.
  return Escaped(words[0] == '\0' ? curl_easy_strerror(code) : words.data());
}

}  // namespace strainwave::bench

// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/mail_message.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::bench::mail_message_test {
namespace {

using Addresses = std::vector<std::string>;

TEST(Base64, IsThatOfTheStandardsTestVectors) {
  // RFC 4648, section 10.
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
}

TEST(MailDate, IsInEnglishAndUtc) {
  EXPECT_EQ(MailDate(1'772'366'400'999), "Sun, 01 Mar 2026 12:00:00 +0000");
  EXPECT_EQ(MailDate(0), "Thu, 01 Jan 1970 00:00:00 +0000");
}

TEST(MailMessage, HasHeadersAndAText) {
  Notice notice;
  notice.id = "7-1";
  notice.utc_ms = 1'772'366'400'000;
  notice.subject = "fault";
  notice.text = "foobar";
  EXPECT_EQ(MailMessage(notice, "bench@lab.example", {"a@lab.example", "b@lab.example"}),
            "Date: Sun, 01 Mar 2026 12:00:00 +0000\r\n"
            "From: bench@lab.example\r\n"
            "To: a@lab.example,\r\n b@lab.example\r\n"
            "Subject: =?utf-8?B?ZmF1bHQ=?=\r\n"
            "Message-ID: <7-1@lab.example>\r\n"
            "Auto-Submitted: auto-generated\r\n"
            "MIME-Version: 1.0\r\n"
            "Content-Type: text/plain; charset=utf-8\r\n"
            "Content-Transfer-Encoding: base64\r\n"
            "\r\n"
            "Zm9vYmFy\r\n");
}

TEST(MailMessage, HasNoLineThatIsTooLongAndNoHeaderFromText) {
  Notice notice;
  for (int i = 0; i < 60; ++i) notice.subject += "µ\r\nBcc: x";
  notice.text = std::string(500, '.');
  const std::string message = MailMessage(notice, "a@b", {"c@d"});
  EXPECT_EQ(message.find("Bcc"), std::string::npos);
  std::size_t begin = 0;
  for (std::size_t end; (end = message.find('\n', begin)) != std::string::npos; begin = end + 1) {
    ASSERT_GT(end, begin);
    EXPECT_EQ(message[end - 1], '\r');
    EXPECT_LE(end - begin, 79U) << message.substr(begin, end - begin);
  }
  EXPECT_EQ(begin, message.size());
}

TEST(MailRecipients, AreTheListsOfTheNotice) {
  const Addresses first{"a@x", "b@x"};
  const Addresses second{"b@x", "c@x"};
  Notice notice;
  EXPECT_EQ(RecipientsOf(notice, first, second), first);
  notice.audience = Audience::kSecond;
  EXPECT_EQ(RecipientsOf(notice, first, second), second);
  EXPECT_EQ(RecipientsOf(notice, first, {}), first);
  notice.audience = Audience::kBoth;
  EXPECT_EQ(RecipientsOf(notice, first, second), (Addresses{"a@x", "b@x", "c@x"}));
}

}  // namespace
}  // namespace strainwave::bench::mail_message_test

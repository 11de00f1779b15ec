// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_settings.h"
#include "tests/checkout.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

namespace strainwave::bench::notice_settings_test {
namespace {

using Texts = std::vector<std::string>;

std::string ErrorsOf(const std::string& text) {
  try {
    ParseNoticeSettings("notices: 1\n" + text, "n.yaml");
  } catch (const NoticeSettingsError& error) {
    return error.what();
  }
  return "none";
}

constexpr const char* kWebhook = "channels: {webhook: {url: \"http://h/\"}}\n";

TEST(NoticeSettings, OfTheExampleNameEveryKey) {
  const NoticeSettings settings =
      ReadNoticeSettings(std::filesystem::path(SourceFolder()) / "bench/notices/notices.yaml");
  EXPECT_EQ(settings.mail->server, "smtp://mail.example:587");
  EXPECT_EQ(settings.mail->from, "bench@lab.example");
  EXPECT_EQ(settings.mail->to, Texts{"operator@lab.example"});
  EXPECT_EQ(settings.mail->escalate_to, Texts{"head@lab.example"});
  EXPECT_EQ(settings.mail->tls, MailTls::kOffered);
  EXPECT_EQ(settings.webhook->url, "http://127.0.0.1:8000/strainwave");
  EXPECT_EQ(settings.mqtt->host, "127.0.0.1");
  EXPECT_EQ(settings.mqtt->port, 1883);
  EXPECT_FALSE(settings.mqtt->tls);
  EXPECT_EQ(settings.mqtt->topic, "strainwave/notices");
  EXPECT_EQ(settings.rules.delay_s, 120.0);
  EXPECT_EQ(settings.rules.escalate_after_s, 1800.0);
  EXPECT_EQ(settings.rules.silence_after_s, 300.0);
  EXPECT_EQ(settings.rules.per_hour, 20);
}

TEST(NoticeSettings, LeaveOutWhatHasADefault) {
  const NoticeSettings settings = ParseNoticeSettings(std::string("notices: 1\n") + kWebhook, "n.yaml");
  EXPECT_FALSE(settings.mail);
  EXPECT_FALSE(settings.mqtt);
  EXPECT_EQ(settings.rules.delay_s, 120.0);
  EXPECT_FALSE(settings.rules.escalate_after_s) << "there is no second list";
  EXPECT_EQ(settings.rules.silence_after_s, 300.0);
}

TEST(NoticeSettings, TellAllMistakesWithTheirPlace) {
  EXPECT_EQ(
      ErrorsOf("channels:\n"
               "  mail:\n"
               "    server: mail.example\n"
               "    from: bench\n"
               "    to: [\"a@b\", \"c d@e\"]\n"
               "  mqtt:\n"
               "    broker: mqtt://h:99999\n"
               "    topic: a/#\n"
               "delay: 5\n"
               "silence_afer: 5 min\n"
               "rate_per_hour: 1\n"),
      "n.yaml:4:13: error: server = mail.example is no address (expected smtp://HOST:PORT or "
      "smtps://HOST:PORT)\n"
      "n.yaml:5:11: error: from = bench is no mail address (expected NAME@HOST, in ASCII)\n"
      "n.yaml:6:9: error: to = c d@e is no mail address (expected NAME@HOST, in ASCII)\n"
      "n.yaml:8:13: error: broker = mqtt://h:99999 is no address (expected mqtt://HOST:PORT or "
      "mqtts://HOST:PORT)\n"
      "n.yaml:9:12: error: topic = a/# has wildcards (expected a topic to publish to)\n"
      "n.yaml:10:8: error: delay = 5: no unit (expected us, ms, s, min, h or d)\n"
      "n.yaml:11:1: error: unknown key 'silence_afer', did you mean 'silence_after'? (expected notices, "
      "channels, delay, escalate_to, escalate_after, silence_after, rate_per_hour)\n"
      "n.yaml:12:16: error: rate_per_hour = 1: out of range (expected a whole number from 2 to 100)");
}

TEST(NoticeSettings, NameAChannel) {
  EXPECT_EQ(ErrorsOf("channels:\n"),
            "n.yaml:2:1: error: channels names none (expected mail, webhook or mqtt)");
  EXPECT_EQ(ErrorsOf("channels: {sms: {to: 1}}\n"),
            "n.yaml:2:1: error: channels names none (expected mail, webhook or mqtt)\n"
            "n.yaml:2:12: error: unknown key 'sms' (expected mail, webhook, mqtt)");
}

TEST(NoticeSettings, HaveASecondListOfMailAlone) {
  EXPECT_EQ(ErrorsOf(std::string(kWebhook) + "escalate_to: a@b\n"),
            "n.yaml:3:14: error: escalate_to has no meaning without mail (expected mail among channels)");
  EXPECT_EQ(ErrorsOf(std::string(kWebhook) + "escalate_after: 1 h\n"),
            "n.yaml:3:17: error: escalate_after stands alone (expected escalate_to, who gets mail then)");
}

TEST(NoticeSettings, TakeAddressesOfServersInAllForms) {
  const auto mqtt = [](const std::string& broker) {
    return *ParseNoticeSettings("notices: 1\nchannels: {mqtt: {broker: \"" + broker + "\"}}\n", "n.yaml")
                .mqtt;
  };
  EXPECT_EQ(mqtt("mqtts://h").port, 8883);
  EXPECT_TRUE(mqtt("mqtts://h").tls);
  EXPECT_EQ(mqtt("mqtt://[::1]").host, "::1");
  EXPECT_EQ(mqtt("mqtt://[::1]:7").port, 7);
  for (const char* broker : {"mqtt://", "mqtt://h:0", "mqtt://u:p@h", "http://h", "mqtt://h/x", "m"}) {
    EXPECT_NE(ErrorsOf(std::string("channels: {mqtt: {broker: \"") + broker + "\"}}\n"), "none") << broker;
  }
}

class NoticeSecrets : public testing::Test {
 protected:
  NoticeSecrets() {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "secret") << "p w\r\nnot this\n";
    std::ofstream(folder_ / "empty") << "\n";
    std::ofstream(folder_ / "url") << "https://h/token\n";
  }
  ~NoticeSecrets() override { std::filesystem::remove_all(folder_); }

  NoticeSettings Read(const std::string& channels) const {
    return ParseNoticeSettings("notices: 1\nchannels:\n" + channels, (folder_ / "n.yaml").string());
  }
  std::string Errors(const std::string& channels) const {
    try {
      Read(channels);
    } catch (const NoticeSettingsError& error) {
      return error.what();
    }
    return "none";
  }
  static std::string Mail(const std::string& more) {
    return "  mail: {server: \"smtp://h\", from: a@b, to: a@b, " + more + "}\n";
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("notice_settings_" + std::to_string(::getpid()));
};

TEST_F(NoticeSecrets, AreTheFirstLineOfAFile) {
  const NoticeSettings settings =
      Read(Mail("user: u, password_file: secret") + "  webhook: {url_file: url}\n");
  EXPECT_EQ(settings.mail->password, "p w");
  EXPECT_EQ(settings.mail->tls, MailTls::kRequired) << "never in the clear unless told so";
  EXPECT_EQ(settings.webhook->url, "https://h/token");
  EXPECT_EQ(Read(Mail("user: u, password_file: secret, tls: none")).mail->tls, MailTls::kNone);
}

TEST_F(NoticeSecrets, AreRepeatedInNoMessage) {
  const std::string at = (folder_ / "n.yaml").string() + ":3:";
  const std::string from = ", from: a@b, to: a@b}\n";
  const std::string in_address =
      " holds more than a host and a port (expected user and password_file as keys of their own)";
  EXPECT_EQ(Errors("  mail: {server: \"smtp://bench:sesame@h\"" + from),
            at + "18: error: server" + in_address);
  EXPECT_EQ(Errors("  mqtt: {broker: \"mqtt://bench:sesame@h:1883\"}\n"),
            at + "18: error: broker" + in_address);
  const std::string not_usable =
      " is not usable (expected one line of 1 to 200 characters; it may be secret and is not shown)";
  EXPECT_EQ(Errors("  mail: {server: \"smtp://bench:sesame@h\\n\"" + from),
            at + "18: error: server" + not_usable);
  EXPECT_EQ(Errors("  webhook: {url: \"https://h/sesame\\n\"}\n"), at + "18: error: url" + not_usable);
}

TEST_F(NoticeSecrets, AreMissedInWords) {
  const std::string at = (folder_ / "n.yaml").string() + ":3:";
  EXPECT_EQ(Errors(Mail("user: u, password_file: missing")),
            at + "74: error: password_file = " + (folder_ / "missing").string() +
                " cannot be read (expected a file of at most 64 KiB with one line)");
  EXPECT_EQ(Errors(Mail("user: u, password_file: empty")),
            at + "74: error: password_file = " + (folder_ / "empty").string() +
                " has no first line (expected what is secret in it)");
  EXPECT_EQ(Errors(Mail("user: u")), at + "56: error: user stands alone (expected user and password_file)");
  EXPECT_EQ(Errors("  webhook: {url: \"http://h\", url_file: url}\n"),
            at + "40: error: url_file stands beside url (expected one of the two)");
  EXPECT_EQ(Errors("  webhook: {url: \"file:///etc/passwd\"}\n"),
            at + "18: error: url holds no address (expected http://HOST… or https://HOST…)");
}

}  // namespace
}  // namespace strainwave::bench::notice_settings_test

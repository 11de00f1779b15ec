// SPDX-License-Identifier: Apache-2.0
#include "bench/plots/gnuplot.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <string_view>

#include <fmt/format.h>

#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

File OpenScratch() {
  File file(std::tmpfile());
  if (!file) {
    throw GnuplotError(
        fmt::format("gnuplot needs a scratch file, and none could be made: {}", std::strerror(errno)));
  }
  return file;
}

std::string ReadAll(std::FILE* file) {
  std::rewind(file);
  std::string text;
  std::array<char, 4096> block{};
  while (const std::size_t n = std::fread(block.data(), 1, block.size(), file)) {
    text.append(block.data(), n);
  }
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) {
    text.pop_back();
  }
  return text;
}

// Signals as usual, however this program takes its own.
class SpawnAttributes {
 public:
  SpawnAttributes() {
    sigset_t signals;
    posix_spawnattr_init(&attributes_);
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&attributes_, &signals);
    for (const int signal : {SIGPIPE, SIGTTIN, SIGTTOU}) sigaddset(&signals, signal);
    posix_spawnattr_setsigdefault(&attributes_, &signals);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  }
  ~SpawnAttributes() { posix_spawnattr_destroy(&attributes_); }
  SpawnAttributes(const SpawnAttributes&) = delete;
  SpawnAttributes& operator=(const SpawnAttributes&) = delete;
  const posix_spawnattr_t* get() const { return &attributes_; }

 private:
  posix_spawnattr_t attributes_;
};

class SpawnActions {
 public:
  SpawnActions() { posix_spawn_file_actions_init(&actions_); }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;
  void Redirect(int from, int to) { posix_spawn_file_actions_adddup2(&actions_, from, to); }
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

// The script and the complaints pass through unnamed files rather than pipes: neither side can block the
// other, and a program that dies early raises no SIGPIPE here.
void RunScript(const std::string& program, const std::string& script) {
  const File in = OpenScratch();
  const File complaints = OpenScratch();
  if (std::fwrite(script.data(), 1, script.size(), in.get()) != script.size() || std::fflush(in.get()) != 0) {
    throw GnuplotError(
        fmt::format("the script for {} could not be written: {}", program, std::strerror(errno)));
  }
  // The child shares the offset of the file.
  lseek(fileno(in.get()), 0, SEEK_SET);

  const SpawnAttributes attributes;
  SpawnActions actions;
  actions.Redirect(fileno(in.get()), STDIN_FILENO);
  actions.Redirect(fileno(complaints.get()), STDOUT_FILENO);
  actions.Redirect(fileno(complaints.get()), STDERR_FILENO);
  std::string name = program;
  // As a file by name: what it is merely fed, gnuplot reads a byte at a time.
  std::string script_file = "/dev/stdin";
  char* arguments[] = {name.data(), script_file.data(), nullptr};
  pid_t child = 0;
  if (const int error =
          posix_spawnp(&child, program.c_str(), actions.get(), attributes.get(), arguments, environ);
      error != 0) {
    throw GnuplotError(fmt::format("{} could not be started: {} (expected the package gnuplot-nox)", program,
                                   std::strerror(error)));
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) {
      throw GnuplotError(fmt::format("{} was lost sight of: {}", program, std::strerror(errno)));
    }
  }
  if (WIFSIGNALED(status)) {
    throw GnuplotError(
        fmt::format("{} was ended by signal {}: {}", program, WTERMSIG(status), ReadAll(complaints.get())));
  }
  if (WEXITSTATUS(status) != 0) {
    throw GnuplotError(fmt::format("{} ended with exit code {}: {}", program, WEXITSTATUS(status),
                                   ReadAll(complaints.get())));
  }
}

fs::path WithSuffix(const fs::path& stem, std::string_view suffix) {
  fs::path path = stem;
  path += suffix;
  return path;
}

std::string BytesOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Whether there is a picture of that name which is not this one.
bool HoldsAnother(const fs::path& name, const fs::path& svg, const fs::path& png) {
  const auto differs = [&](std::string_view ending, const fs::path& file) {
    const fs::path there = WithSuffix(name, ending);
    return fs::exists(there) && BytesOf(there) != BytesOf(file);
  };
  return differs(".svg", svg) || differs(".png", png);
}

}  // namespace

fs::path RenderPictureWith(const std::string& program, const std::string& script, const fs::path& stem,
                           PictureSize size) {
  if (stem.has_parent_path()) {
    fs::create_directories(stem.parent_path());
  }
  const fs::path svg = WithSuffix(stem, ".svg.part");
  const fs::path png = WithSuffix(stem, ".png.part");
  // One terminal counts type in pixels, the other in points: the scale makes one script serve both.
  const std::string both = fmt::format(
      "set encoding utf8\n"
      "set terminal svg size {0},{1} font 'sans-serif,15' rounded background rgb 'white' noenhanced\n"
      "set output {2}\n{4}\nunset output\n"
      "reset\n"
      "set terminal pngcairo size {0},{1} font 'sans-serif,15' fontscale 0.75 rounded background rgb 'white' "
      "noenhanced\n"
      "set output {3}\n{4}\nunset output\n",
      size.width_px, size.height_px, Quoted(svg.string()), Quoted(png.string()), script);
  try {
    RunScript(program, both);
    for (const fs::path& part : {svg, png}) {
      if (!fs::exists(part) || fs::file_size(part) == 0) {
        throw GnuplotError(fmt::format("{} left no picture at {}", program, part.string()));
      }
    }
  } catch (const GnuplotError&) {
    std::error_code ignored;
    fs::remove(svg, ignored);
    fs::remove(png, ignored);
    throw;
  }
  fs::path name = stem;
  for (int number = 2; HoldsAnother(name, svg, png); ++number)
    name = WithSuffix(stem, fmt::format("_{}", number));
  fs::rename(svg, WithSuffix(name, ".svg"));
  fs::rename(png, WithSuffix(name, ".png"));
  return name;
}

fs::path RenderPicture(const std::string& script, const fs::path& stem, PictureSize size) {
  return RenderPictureWith("gnuplot", script, stem, size);
}

}  // namespace strainwave::bench

// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/can/socket_can_bus.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/errqueue.h>
#include <linux/net_tstamp.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace strainwave::bench {
namespace {

using protocols::CanFrame;
using std::chrono::nanoseconds;

constexpr std::size_t kMostFilters = 64;

nanoseconds Now(clockid_t clock) noexcept {
  timespec time{};
  ::clock_gettime(clock, &time);
  return NanosecondsOf(time);
}

[[noreturn]] void Throw(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int number() const { return number_; }
  int Release() { return std::exchange(number_, -1); }

 private:
  int number_;
};

template <typename Value>
void SetOption(int socket, int level, int name, const Value& value, const char* what) {
  if (::setsockopt(socket, level, name, &value, sizeof value) != 0) Throw(errno, what);
}

int OpenSocket(const std::string& interface) {
  Descriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW));
  if (socket.number() < 0 && (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT)) {
    Throw(errno,
          fmt::format(
              "CAN interface {}: this kernel has no CAN (try: modprobe can can_raw vcan; ip link add dev {} "
              "type vcan; ip link set up {}; or use the in-process bus)",
              interface, interface, interface));
  }
  if (socket.number() < 0) Throw(errno, "a CAN socket");

  ifreq request{};
  if (interface.empty() || interface.size() >= sizeof request.ifr_name) {
    throw std::invalid_argument(fmt::format("interface = '{}' (must have 1 to {} characters)", interface,
                                            sizeof request.ifr_name - 1));
  }
  interface.copy(request.ifr_name, sizeof request.ifr_name - 1);
  if (::ioctl(socket.number(), SIOCGIFINDEX, &request) != 0) {
    Throw(errno,
          fmt::format(
              "CAN interface {} (ip link show type can; for a virtual one: ip link add dev {} type vcan; "
              "ip link set up {})",
              interface, interface, interface));
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = request.ifr_ifindex;
  if (::ioctl(socket.number(), SIOCGIFFLAGS, &request) != 0) Throw(errno, "CAN interface " + interface);
  if ((request.ifr_flags & IFF_UP) == 0) {
    Throw(ENETDOWN,
          fmt::format("CAN interface {} (a real one: ip link set {} type can bitrate 1000000; then: ip link "
                      "set up {})",
                      interface, interface, interface));
  }
  const int number = socket.number();
  const can_err_mask_t errors = CAN_ERR_MASK;
  SetOption(number, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors, "error frames of a CAN socket");
  SetOption(number, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, 1, "confirmations of a CAN socket");
  SetOption(number, SOL_SOCKET, SO_RXQ_OVFL, 1, "loss counter of a CAN socket");
  const int stamps = SOF_TIMESTAMPING_RX_HARDWARE | SOF_TIMESTAMPING_RAW_HARDWARE |
                     SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE;
  SetOption(number, SOL_SOCKET, SO_TIMESTAMPING, stamps, "time stamps of a CAN socket");
  // The least that the kernel allows: what it holds is out of our hands.
  SetOption(number, SOL_SOCKET, SO_SNDBUF, 0, "send buffer of a CAN socket");
  if (::bind(number, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    Throw(errno,
          fmt::format("interface {} is none of CAN (expected one of 'ip link show type can' or 'type vcan')",
                      interface));
  }
  return socket.Release();
}

can_frame ToKernel(const CanFrame& frame) {
  can_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0) | (frame.remote ? CAN_RTR_FLAG : 0) |
               (frame.error ? CAN_ERR_FLAG : 0);
  raw.can_dlc = std::min<std::uint8_t>(frame.length, CAN_MAX_DLEN);
  std::copy_n(frame.data.begin(), raw.can_dlc, raw.data);
  return raw;
}

CanFrame FromKernel(const can_frame& raw) {
  CanFrame frame;
  frame.error = (raw.can_id & CAN_ERR_FLAG) != 0;
  frame.extended = !frame.error && (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = !frame.error && (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.id = raw.can_id & (frame.error ? CAN_ERR_MASK : frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.length = std::min<std::uint8_t>(raw.can_dlc, CAN_MAX_DLEN);
  if (!frame.remote) std::copy_n(raw.data, frame.length, frame.data.begin());
  return frame;
}

}  // namespace

std::vector<CanFilter> FiltersOfNode(int node) {
  return {{0x000, 0x7FF}, {0x080, 0x7FF}, {0x700, 0x780}, {static_cast<std::uint32_t>(node), 0x07F}};
}

SocketCanBus::SocketCanBus(const SocketCanSettings& settings)
    : interface_(settings.interface),
      clock_zero_(settings.clock_zero),
      most_in_flight_(settings.most_in_flight),
      filters_(settings.filters),
      filtered_(!settings.filters.empty()),
      queue_(settings.transmit_frames) {
  if (most_in_flight_ == 0 || queue_.empty()) {
    throw std::invalid_argument(
        fmt::format("most_in_flight = {}, transmit_frames = {} (both must be at least 1)", most_in_flight_,
                    queue_.size()));
  }
  if (filters_.size() > kMostFilters / 2) {
    throw std::invalid_argument(
        fmt::format("filters has {} entries (must be at most {})", filters_.size(), kMostFilters / 2));
  }
  filters_.reserve(kMostFilters);
  socket_ = OpenSocket(settings.interface);
  if (const int bytes = settings.receive_bytes; bytes > 0) {
    // Refused to ordinary users, who get what they may.
    if (::setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) != 0) {
      (void)::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    }
  }
  if (filtered_ && !SetFilters()) {
    const int error = errno;
    ::close(socket_);
    Throw(error, "filters of CAN interface " + settings.interface);
  }
}

SocketCanBus::~SocketCanBus() { ::close(socket_); }

bool SocketCanBus::SetFilters() noexcept {
  std::array<can_filter, kMostFilters> raw{};
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    const CanFilter& filter = filters_[i];
    raw[i].can_id = filter.id | (filter.extended ? CAN_EFF_FLAG : 0);
    raw[i].can_mask = filter.mask | CAN_EFF_FLAG;
  }
  return ::setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, raw.data(),
                      static_cast<socklen_t>(filters_.size() * sizeof raw[0])) == 0;
}

bool SocketCanBus::Passes(const CanFrame& frame) const noexcept {
  return !filtered_ || std::any_of(filters_.begin(), filters_.end(), [&](const CanFilter& filter) {
    return filter.extended == frame.extended && (filter.id & filter.mask) == (frame.id & filter.mask);
  });
}

void SocketCanBus::Gone() noexcept {
  state_ = CanState::kGone;
  queued_ = in_flight_ = 0;
}

bool SocketCanBus::IsUp() const noexcept {
  ifreq request{};
  interface_.copy(request.ifr_name, sizeof request.ifr_name - 1);
  return ::ioctl(socket_, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

SocketCanBus::Written SocketCanBus::Write(const CanFrame& frame) noexcept {
  if (in_flight_ >= most_in_flight_) return Written::kNotNow;
  const can_frame raw = ToKernel(frame);
  if (::send(socket_, &raw, sizeof raw, MSG_DONTWAIT) == sizeof raw) {
    ++in_flight_;
    if (state_ == CanState::kGone) state_ = CanState::kErrorActive;
    return Written::kYes;
  }
  if (errno == ENOBUFS || errno == EAGAIN || errno == EINTR) return Written::kNotNow;
  Gone();
  return Written::kNever;
}

void SocketCanBus::Flush() noexcept {
  while (queued_ > 0 && Write(queue_[first_]) == Written::kYes) {
    first_ = (first_ + 1) % queue_.size();
    --queued_;
  }
}

CanBus::Sent SocketCanBus::Send(const CanFrame& frame) noexcept {
  if (state_ == CanState::kBusOff) return Sent::kDown;
  // An own frame comes back only if it passes the filters, and the first of an id opens them for it.
  if (!Passes(frame)) {
    if (filters_.size() == kMostFilters) return Sent::kFull;
    filters_.push_back({frame.id, frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK, frame.extended});
    if (!SetFilters()) return Sent::kDown;
  }
  // Confirmations may wait to be read; a frame of others that is met meanwhile is kept.
  bool own = true;
  while (in_flight_ >= most_in_flight_ && !keeps_ && own && ReadOne(kept_, own)) keeps_ = !own;
  Flush();
  if (queued_ == 0) {
    const Written written = Write(frame);
    if (written == Written::kYes) return Sent::kQueued;
    if (written == Written::kNever) return Sent::kDown;
  }
  if (queued_ == queue_.size()) return Sent::kFull;
  queue_[(first_ + queued_) % queue_.size()] = frame;
  ++queued_;
  return Sent::kQueued;
}

bool SocketCanBus::Receive(ReceivedFrame& received) noexcept {
  if (keeps_) {
    received = kept_;
    keeps_ = false;
    return true;
  }
  bool own = true;
  while (own) {
    if (!ReadOne(received, own)) return false;
    if (own) Flush();
  }
  return true;
}

bool SocketCanBus::ReadOne(ReceivedFrame& received, bool& own) noexcept {
  can_frame raw{};
  iovec part{&raw, sizeof raw};
  alignas(cmsghdr) char control[256];
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  const ssize_t length = ::recvmsg(socket_, &message, MSG_DONTWAIT);
  if (length < 0 && (errno == ENETDOWN || errno == ENODEV || errno == ENXIO)) Gone();
  if (length != sizeof raw) return false;
  TakeControl(&message, received);
  // What had come in before stays to be read; it does not say that the interface is up again.
  if (state_ == CanState::kGone && IsUp()) state_ = CanState::kErrorActive;
  received.frame = FromKernel(raw);
  own = (message.msg_flags & MSG_CONFIRM) != 0;
  if (own && in_flight_ > 0) --in_flight_;
  if (received.frame.error) TakeError(received.frame);
  return true;
}

void SocketCanBus::TakeControl(const void* message, ReceivedFrame& received) noexcept {
  const nanoseconds arrival = Now(CLOCK_MONOTONIC);
  nanoseconds time = arrival;
  // CMSG_NXTHDR takes no pointer to const.
  msghdr header = *static_cast<const msghdr*>(message);
  for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr; part = CMSG_NXTHDR(&header, part)) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t drops{};
      std::memcpy(&drops, CMSG_DATA(part), sizeof drops);
      lost_ += drops - kernel_drops_;
      // Confirmations may be among the lost ones.
      if (drops != kernel_drops_) in_flight_ = 0;
      kernel_drops_ = drops;
    } else if (part->cmsg_type == SO_TIMESTAMPING) {
      scm_timestamping stamps{};
      std::memcpy(&stamps, CMSG_DATA(part), sizeof stamps);
      time = TimeOfFrame(stamps.ts, arrival, Now(CLOCK_REALTIME), device_clock_);
    }
  }
  received.time = time - clock_zero_;
}

void SocketCanBus::TakeError(const CanFrame& frame) noexcept {
  if ((frame.id & CAN_ERR_CRTL) != 0) {
    const unsigned status = frame.data[1];
    if ((status & CAN_ERR_CRTL_RX_OVERFLOW) != 0) ++lost_;  // in the controller, which counts no further
    if ((status & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
      state_ = CanState::kErrorPassive;
    } else if ((status & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
      state_ = CanState::kErrorWarning;
    } else if ((status & CAN_ERR_CRTL_ACTIVE) != 0) {
      state_ = CanState::kErrorActive;
    }
  }
  if ((frame.id & CAN_ERR_RESTARTED) != 0) state_ = CanState::kErrorActive;
  if ((frame.id & CAN_ERR_BUSOFF) != 0) state_ = CanState::kBusOff;
  if ((frame.id & (CAN_ERR_BUSOFF | CAN_ERR_RESTARTED)) != 0) queued_ = in_flight_ = 0;
}

}  // namespace strainwave::bench

#include "can/route_socket.hpp"

#include <linux/netlink.h>
#include <netlink/attr.h>
#include <netlink/msg.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "can/descriptor.hpp"

namespace servoctl::can {
namespace {

/// A change is carried out while it is sent; an adapter on USB takes its time for it.
constexpr Duration kPatienceForRoute = std::chrono::seconds(2);

Descriptor open_route() {
  Descriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  const int on = 1;
  if (socket) {
    (void)::setsockopt(socket.get(), SOL_NETLINK, NETLINK_EXT_ACK, &on, sizeof on);
    (void)::setsockopt(socket.get(), SOL_NETLINK, NETLINK_CAP_ACK, &on, sizeof on);
  }
  return socket;
}

/// What the kernel says of its error; the question stands before it unless it was cut off.
std::string words_of(const nlmsghdr& head, const nlmsgerr& error) {
  if ((head.nlmsg_flags & NLM_F_ACK_TLVS) == 0) return {};
  std::size_t at = sizeof(nlmsgerr);
  if ((head.nlmsg_flags & NLM_F_CAPPED) == 0 && error.msg.nlmsg_len >= sizeof(nlmsghdr))
    at += error.msg.nlmsg_len - sizeof(nlmsghdr);
  const auto size = static_cast<std::size_t>(nlmsg_datalen(&head));
  at = NLMSG_ALIGN(at);
  if (at >= size) return {};
  auto* data = static_cast<std::uint8_t*>(nlmsg_data(&head)) + at;
  std::array<nlattr*, NLMSGERR_ATTR_MAX + 1> found{};
  if (nla_parse(found.data(), NLMSGERR_ATTR_MAX, reinterpret_cast<nlattr*>(data), static_cast<int>(size - at),
                nullptr) < 0 ||
      found[NLMSGERR_ATTR_MSG] == nullptr)
    return {};
  const auto* text = static_cast<const char*>(nla_data(found[NLMSGERR_ATTR_MSG]));
  return {text, ::strnlen(text, static_cast<std::size_t>(nla_len(found[NLMSGERR_ATTR_MSG])))};
}

}  // namespace

RouteAnswer parse_route_answer(ByteSpan message) {
  Bytes copy(message.begin(), message.end());  // libnl takes no const, and wants it aligned.
  copy.resize(std::max(copy.size(), sizeof(nlmsghdr)));
  const auto* head = reinterpret_cast<const nlmsghdr*>(copy.data());
  if (nlmsg_ok(head, static_cast<int>(message.size())) == 0) return {EBADMSG, {}, {}};
  if (head->nlmsg_type != NLMSG_ERROR) return {0, {}, std::move(copy)};
  if (nlmsg_datalen(head) < static_cast<int>(sizeof(nlmsgerr))) return {EBADMSG, {}, {}};
  const auto* error = static_cast<const nlmsgerr*>(nlmsg_data(head));
  return {-error->error, error->error == 0 ? std::string() : words_of(*head, *error), {}};
}

RouteAnswer ask_route(ByteSpan message) {
  const auto socket = open_route();
  if (!socket) return {errno, {}, {}};
  while (::send(socket.get(), message.data(), message.size(), 0) < 0)
    if (errno != EINTR) return {errno, {}, {}};
  const auto limit = steady_now() + kPatienceForRoute;
  std::array<std::uint8_t, 32768> answer{};
  for (;;) {
    const auto woken = wait_for(socket.get(), POLLIN, limit);
    if (woken == Wake::elapsed) return {ETIMEDOUT, {}, {}};
    if (woken == Wake::interrupted) continue;
    const auto size = ::recv(socket.get(), answer.data(), answer.size(), MSG_DONTWAIT);
    if (size > 0) return parse_route_answer(std::span(answer).first(static_cast<std::size_t>(size)));
    if (size == 0 || (errno != EINTR && errno != EAGAIN)) return {size == 0 ? EPIPE : errno, {}, {}};
  }
}

}  // namespace servoctl::can

#include "gateway/address.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/un.h>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::gateway {
namespace {

constexpr std::string_view kPlaceForm =
    "write 127.0.0.1:60000, or a path such as /run/gateway for a socket of this machine";
constexpr std::string_view kUrlForm =
    "a gateway is written gateway://HOST, gateway://HOST:60000, gateway://HOST/NET or gateway:/run/socket";

tl::unexpected<Error> wrong(std::string_view text, const Message& what, std::string_view form) {
  return fail(Errc::usage, message("'{}' is not a place of a gateway: {}", as_it_is(text), what),
              std::string(form));
}

Result<Address> read_path(std::string_view text, std::string_view form) {
  if (text.size() >= sizeof(sockaddr_un::sun_path))
    return wrong(text, message("a path of a socket has {} bytes at most", sizeof(sockaddr_un::sun_path) - 1),
                 form);
  Address out;
  out.path = text;
  return out;
}

Result<Address> read_host(std::string_view text, std::string_view whole, std::string_view form) {
  Address out;
  const auto bracket = text.starts_with('[') ? text.find(']') : std::string_view::npos;
  const auto colon = text.find(':', bracket == std::string_view::npos ? 0 : bracket);
  auto host = text.substr(0, colon);
  if (bracket != std::string_view::npos && host.size() == bracket + 1) host = host.substr(1, bracket - 1);
  if (host.empty() || host.find_first_of(" \t\r\n[]@/") != std::string_view::npos)
    return wrong(whole, "the host is missing", form);
  out.host = host;
  if (colon == std::string_view::npos) return out;
  const auto port = parse_digits(text.substr(colon + 1), 10);
  if (!port || *port == 0 || *port > 0xFFFF)
    return wrong(whole, message("'{}' is no port", as_it_is(text.substr(colon + 1))), form);
  out.port = static_cast<std::uint16_t>(*port);
  return out;
}

}  // namespace

bool Address::is_local() const {
  if (is_path() || equals_nocase(host, "localhost")) return true;
  in_addr four{};
  if (::inet_pton(AF_INET, host.c_str(), &four) == 1) return (ntohl(four.s_addr) >> 24U) == 127;
  in6_addr six{};
  return ::inet_pton(AF_INET6, host.c_str(), &six) == 1 && IN6_IS_ADDR_LOOPBACK(&six);
}

std::string Address::text() const {
  if (is_path()) return path;
  return host.find(':') == std::string::npos ? formatted("{}:{}", host, port)
                                             : formatted("[{}]:{}", host, port);
}

Result<Address> parse_place(std::string_view text) {
  return text.starts_with('/') ? read_path(text, kPlaceForm) : read_host(text, text, kPlaceForm);
}

Result<Address> parse_url(std::string_view text) {
  if (!text.starts_with("//"))
    return text.starts_with('/') && text.size() > 1 ? read_path(text, kUrlForm)
                                                    : wrong(text, "neither a host nor a path", kUrlForm);
  const auto rest = text.substr(2);
  const auto slash = rest.find('/');
  auto out = read_host(rest.substr(0, slash), text, kUrlForm);
  if (!out || slash == std::string_view::npos) return out;
  const auto network = parse_digits(rest.substr(slash + 1), 10);
  if (!network || *network == 0 || *network > 0xFFFF)
    return wrong(text, message("'{}' is no number of a network", as_it_is(rest.substr(slash + 1))), kUrlForm);
  out->network = static_cast<std::uint16_t>(*network);
  return out;
}

}  // namespace servoctl::gateway

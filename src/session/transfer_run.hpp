#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "session/session.hpp"

namespace servoctl::session {

/// One call of Session::transfer(): a channel for each node, each working off its own requests.
class TransferRun {
 public:
  TransferRun(Session& session, std::span<const SdoRequest> requests);
  std::vector<Result<Bytes>> run();

 private:
  struct Lane {
    std::uint8_t node = 0;
    std::unique_ptr<ObjectChannel> objects;
    std::vector<std::size_t> requests;  ///< In their order, of all nodes' requests.
    std::size_t started = 0;            ///< How many of them.
    std::size_t current = 0;
    std::uint32_t tries = 0;                ///< That the present request has had before.
    TimePoint begun{};                      ///< Of its first.
    bool asked = false;                     ///< The present request has no result yet.
    std::size_t told = 0;                   ///< Bytes of the present transfer that were told as progress.
    TimePoint deadline = TimePoint::min();  ///< Of `objects`, as it last was.
  };

  void serve(Lane& channel);
  bool advance(Lane& channel);
  void ask(Lane& channel, canopen::Transfer transfer);
  void start(Lane& channel);
  bool answer_for(Lane& channel);
  void finish(Lane& channel, Result<Bytes> result);
  void tell(const Lane& channel, TimePoint ended) const;
  void skip_rest(Lane& channel, const Error& reason, bool reads_too);
  void fail_all(const Error& error);
  void tell_progress();
  std::vector<Result<Bytes>> send_nothing();
  std::vector<Result<Bytes>> give_back();

  Session* session_;
  std::span<const SdoRequest> requests_;
  std::vector<Lane> channels_;
  std::array<int, 128> channel_of_node_{};
  std::vector<Result<Bytes>> results_;
  std::size_t open_ = 0;
  TimePoint until_;          ///< No request begins from then on.
  std::size_t in_turn_ = 0;  ///< How many at most go one after the other.
};

}  // namespace servoctl::session

#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>

#include "session/storage.hpp"
#include "settings/change.hpp"

namespace servoctl::settings {

/// The storage of every node that is written to by one command.
class KeepingNodes {
 public:
  /// `changes` outlive it.
  KeepingNodes(show::Desk& desk, std::span<const Change> changes);

  /// From now on nothing is sent: what would be goes there, which outlives this.
  void rehearse(session::Rehearsal& rehearsal);

  /// Before the writes. After an error nothing is open any more.
  Result<void> open(const WriteOptions& options);
  /// After the writes: a node of which one write failed stores nothing. What goes wrong is in
  /// `desk.errors`.
  void close(std::span<const Result<session::Written>> written);

  /// Whether a written value survives power-off; null where the manual does not state it.
  report::Value kept(const Change& change) const;

 private:
  bool is_unchanged(std::uint8_t node) const;
  bool goes_to_memory(const Change& change) const;
  void close_node(std::uint8_t node, session::StorageScope& storage, bool all_written, std::size_t writes);

  show::Desk* desk_;
  std::span<const Change> changes_;
  std::map<std::uint8_t, std::unique_ptr<session::StorageScope>> nodes_;
  std::map<std::uint8_t, session::Kept> kept_;
};

/// `yes`, `no`, or that it is not stated.
report::Value kept_text(const report::Value& kept);

}  // namespace servoctl::settings

#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "drive/cia402.hpp"
#include "session/object_survey.hpp"
#include "session/session.hpp"

namespace servoctl::session {

struct IndexRange {
  std::uint16_t first = 0;
  std::uint16_t last = 0;
  bool operator==(const IndexRange&) const = default;
};

/// An entry that a scan found.
struct ScannedEntry {
  ObjectAddress object;
  bool readable = true;  ///< False: it can only be written (abort 0601 0001h).
  std::size_t size = 0;  ///< Bytes that were read.
  Bytes begin = {};      ///< The first kScannedBytes of them.
  bool operator==(const ScannedEntry&) const = default;
};
inline constexpr std::size_t kScannedBytes = 32;

/// What may be there and was not read: the abort code, or one of the reasons below.
struct ScanRefusal {
  ObjectAddress object;
  std::uint32_t abort_code = 0;
  bool operator==(const ScanRefusal&) const = default;
};
inline constexpr std::uint32_t kWasSilent = 0;
inline constexpr std::uint32_t kAnsweredWrongly = 1;  ///< Not as the protocol says, or too long.
inline constexpr std::uint32_t kRaisedAlarm = 2;  ///< An EMCY came while this and its neighbours were read.
/// Bytes of an object above which it is not read to its end: kAnsweredWrongly.
inline constexpr std::size_t kLongestScanned = std::size_t{64} << 10U;

/// A scan, or as much of it as is done.
struct ScanState {
  std::vector<IndexRange> ranges;
  std::size_t done = 0;                    ///< Indexes of the ranges, in their order, that are done.
  std::vector<ScannedEntry> entries = {};  ///< In the order in which they were found.
  std::vector<ScanRefusal> refusals = {};

  std::size_t indexes() const;  ///< Of all ranges.
  std::uint16_t index_at(std::size_t place) const;
};

/// What is said of a node that answers reads of 1000h and none of this object, which it is likely to lack.
Error silent_about_absence(std::uint8_t node, ObjectAddress object);

/// Finds the objects of a node by reading: sub-index 0 of each index of the ranges, then the sub-indices of
/// what is there, as many as it counts and further ones as long as there are any. Writes nothing. Watches the
/// statuswords of the axes: it ends when one is energised, and when the node restarts.
class ObjectScan {
 public:
  /// `statuswords`: those that the node has. An axis that reacts to a fault is waited for.
  ObjectScan(Session& session, std::uint8_t node, ObjectSurvey& survey,
             std::vector<ObjectAddress> statuswords, ScanState& state);

  /// Continues after the indexes that are done; `keep` is called now and then, and before an error is
  /// returned. The errors are those of ObjectSurvey::read(), Errc::refused for a drive that is enabled, that
  /// restarted, or whose answers do not show what it lacks, and Errc::timeout for one that does not answer
  /// for what it lacks. After an EMCY the indexes that were read meanwhile are noted as refused and are done.
  Result<void> run(const std::function<Result<void>()>& keep);
  /// The abort code by which this node says that it lacks an object, where it is none of CiA 301 for that.
  std::optional<std::uint32_t> lacking_code() const { return lacking_code_; }

 private:
  Result<void> learn_lacking_code();
  Result<void> scan_part(std::size_t count);
  Result<std::vector<Result<Bytes>>> take_part(const std::vector<ObjectAddress>& wanted);
  Result<void> judge_state(const std::vector<Result<Bytes>>& statuswords);
  Result<drive::DriveState> end_of_reaction(ObjectAddress statusword);
  Result<void> take_index(std::uint16_t index, const Result<Bytes>& first);
  Result<void> walk_subs(std::uint16_t index, const Result<Bytes>& first);
  Result<void> take_subs(std::uint16_t index, unsigned counted, std::optional<std::uint32_t> end_code);
  Result<std::vector<Result<Bytes>>> read(std::span<const ObjectAddress> objects);
  Result<Result<Bytes>> read_one(std::uint16_t index, unsigned sub);
  bool is_absent(const Result<Bytes>& answer) const;
  void take(ObjectAddress object, const Result<Bytes>& answer);

  Session* session_;
  std::uint8_t node_;
  ObjectSurvey* survey_;
  std::vector<ObjectAddress> statuswords_;
  ScanState* state_;
  std::uint32_t boots_;
  std::size_t silent_in_a_row_ = 0;
  std::optional<std::uint32_t> lacking_code_;
};

}  // namespace servoctl::session

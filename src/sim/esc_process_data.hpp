#pragma once

#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "sim/drive_model.hpp"

namespace servoctl::sim {

/// The process data of a simulated drive on EtherCAT: which objects its outputs and inputs carry, as 1C12h
/// and 1C13h and the mappings they name say (ETG.1000.6, 5.6.7.4), and how they come and go.
class EscProcessData {
 public:
  explicit EscProcessData(DriveModel& model) : model_(&model) {}

  /// Looks at the objects; what is found holds until the next time. 0, or the AL status code: a PDO is
  /// assigned that the drive does not have.
  std::uint16_t load();

  std::size_t output_size() const { return size_of(outputs_); }  ///< Bytes.
  std::size_t input_size() const { return size_of(inputs_); }
  /// Each output goes through the checks that every write goes through; what an object does not take is not
  /// taken, the others are.
  void apply(ByteSpan outputs);
  Bytes sample();
  bool carries_output(ObjectAddress object) const;

 private:
  struct Field {
    ObjectAddress object;
    std::size_t bits = 0;
    bool known = false;  ///< Else a gap.
  };
  using Fields = std::vector<Field>;

  bool load(const std::string& assignment, Fields& out) const;
  void add_mapping(std::uint16_t index, Fields& out) const;
  static std::size_t size_of(const Fields& fields);

  DriveModel* model_;
  Fields outputs_;
  Fields inputs_;
};

}  // namespace servoctl::sim

// Attributes and small datasets: texts and numbers. What is missing, of another kind or larger than
// such things are is as if it were not there. Called under an Hdf5Lock.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "storage/hdf5/hdf5_handle.h"

namespace voxweld {

// Texts of an attribute, one or an array of them, of fixed or variable length.
std::vector<std::string> text_attributes(hid_t object, const std::string& name);
// The only one; or, where there are several of one character each, these in a row, as Imaris has it.
std::optional<std::string> text_attribute(hid_t object, const std::string& name);
// Numbers of any kind as double.
std::vector<double> number_attributes(hid_t object, const std::string& name);
// A number, also where it is written as text.
std::optional<double> number_attribute(hid_t object, const std::string& name);

// All numbers of a dataset with at most `most` of them, and its sizes.
struct SmallDataset {
  std::vector<hsize_t> dims;
  std::vector<double> values;
};
std::optional<SmallDataset> small_dataset(hid_t dataset, hsize_t most);

// Sizes of a dataspace; nothing of a null one.
std::optional<std::vector<hsize_t>> space_dims(hid_t space);

}  // namespace voxweld

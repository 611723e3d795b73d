// HDF5 files that write_hdf5.py makes, and what is to be read of them.
#pragma once

#include "tests/storage/volumes/known_volume.h"
#include "tests/support/python_script.h"

namespace voxweld::testing {

class Hdf5Files : public ::testing::Test {
 protected:
  void SetUp() override {
    VOXWELD_NEEDS_PYTHON("h5py");
    python_ = *python_with("h5py");
  }
  // Makes files of these names.
  void make(std::vector<std::string> names) const {
    names.insert(names.begin(), folder_.path().string());
    run_script(python_, VOXWELD_WRITE_HDF5, names);
  }
  std::string path(const std::string& name, const std::string& ending = "h5") const {
    return (folder_ / (name + "." + ending)).string();
  }
  // What h5py reads.
  KnownVolume expected(const std::string& name, SampleType type, Index3 size) const {
    return {type, size, read_whole_file(path(name, "raw"))};
  }
  void expect_reads(const std::string& name, SampleType type, Index3 size = {33, 18, 20}) const {
    SCOPED_TRACE(name);
    const auto source = open_volume({.path = path(name)});
    expect_volume(*source, expected(name, type, size));
  }
  std::string said_of(const std::string& name) const {
    return complaint(InputSpec{.path = path(name)});
  }

  const TempDirectory folder_;

 private:
  std::string python_;
};

inline std::string dataset_text(const std::string& file, const std::string& dataset = "/data") {
  return file + ": dataset '" + dataset + "'";
}

inline InputSpec with_dataset(const std::string& path, const std::string& dataset) {
  InputSpec spec{.path = path};
  spec.select.dataset = dataset;
  return spec;
}

}  // namespace voxweld::testing

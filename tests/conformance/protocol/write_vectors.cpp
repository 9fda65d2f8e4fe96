// SPDX-License-Identifier: Apache-2.0
// Writes protocol/vectors/v1 anew: `write_protocol_vectors DIRECTORY`. Run it only for a message
// that is new; the bytes of those that exist are frozen.
#include "tests/conformance/protocol/samples.h"

#include <fstream>
#include <iostream>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: write_protocol_vectors DIRECTORY\n";
    return 2;
  }
  for (const auto& sample : limn::protocol::samples()) {
    std::ofstream out(std::string(argv[1]) + "/" + sample.file, std::ios::binary);
    out.write(
        reinterpret_cast<const char*>(sample.bytes.data()),
        static_cast<std::streamsize>(sample.bytes.size()));
    if (!out.flush()) {
      std::cerr << "write_protocol_vectors: cannot write " << sample.file << '\n';
      return 1;
    }
  }
  return 0;
}

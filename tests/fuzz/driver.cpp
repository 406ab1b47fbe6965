// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a fuzz target where there is no libFuzzer: on the files of a corpus, then on seeded
// changes of them, as many as asked for or for as many seconds.
//
//     remanifold_fuzz [--count N] [--seconds S] [--seed N] [--keep FILE] FILES, FOLDERS...
//
// The input in work is kept in a file, so that it is there after a crash. What is printed at
// the end has a digest of all results: builds that differ find the same.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

std::uint64_t digest_of_all_results();
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

namespace fs = std::filesystem;
using Input = std::vector<std::uint8_t>;

Input read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void keep(const std::string& path, const Input& input) {
  if (!path.empty()) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(input.data()),
               static_cast<std::streamsize>(input.size()));
  }
}

/// Some bytes are others, come twice, are gone, or are those of another input.
Input changed(Input input, const Input& other, std::mt19937_64& random) {
  const auto below = [&](std::size_t count) {
    return static_cast<std::size_t>(random() % std::max<std::size_t>(count, 1));
  };
  for (std::size_t i = 1 + below(6); i > 0; --i) {
    const std::size_t place = below(input.size());
    const auto at = input.begin() + static_cast<std::ptrdiff_t>(place);
    switch (below(5)) {
      case 0:
        input.insert(at, static_cast<std::uint8_t>(random()));
        break;
      case 1:
        if (!input.empty()) {
          input.erase(at, at + static_cast<std::ptrdiff_t>(
                                   std::min(input.size() - place, below(8) + 1)));
        }
        break;
      case 2: {
        const std::size_t start = below(other.size());
        const std::size_t size = std::min(other.size() - start, below(32));
        const auto from = other.begin() + static_cast<std::ptrdiff_t>(start);
        input.insert(at, from, from + static_cast<std::ptrdiff_t>(size));
        break;
      }
      default:
        if (!input.empty()) {
          input[place] = static_cast<std::uint8_t>(random());
        }
    }
  }
  input.resize(std::min<std::size_t>(input.size(), 600));
  return input;
}

}  // namespace

int main(int argc, char** argv) {
  double seconds = 0;
  std::uint64_t most = 0;
  std::uint64_t seed = 1;
  std::string kept;
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.rfind("--", 0) == 0 && i + 1 < argc) {
      const char* const value = argv[++i];
      if (word == "--seconds") {
        seconds = std::strtod(value, nullptr);
        most = UINT64_MAX;
      } else if (word == "--count") {
        seconds = 1e9;
        most = std::strtoull(value, nullptr, 10);
      } else if (word == "--seed") {
        seed = std::strtoull(value, nullptr, 10);
      } else if (word == "--keep") {
        kept = value;
      } else {
        std::fprintf(stderr, "remanifold_fuzz: unknown option %s\n", word.c_str());
        return 2;
      }
    } else if (fs::is_directory(word)) {
      for (const auto& entry : fs::directory_iterator(word)) {
        files.push_back(entry.path());
      }
    } else {
      files.emplace_back(word);
    }
  }
  std::sort(files.begin(), files.end());
  std::vector<Input> inputs;
  for (const fs::path& file : files) {
    inputs.push_back(read(file));
    kept.empty() ? void() : keep(kept, inputs.back());
    LLVMFuzzerTestOneInput(inputs.back().data(), inputs.back().size());
  }
  if (inputs.empty()) {
    std::fprintf(stderr, "remanifold_fuzz: no files to begin with\n");
    return 2;
  }
  std::mt19937_64 random(seed);
  std::uint64_t count = 0;
  const auto start = std::chrono::steady_clock::now();
  const auto since = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
        .count();
  };
  while (count < most && since() < seconds) {
    const Input input = changed(inputs[random() % inputs.size()],
                                inputs[random() % inputs.size()], random);
    keep(kept, input);
    LLVMFuzzerTestOneInput(input.data(), input.size());
    ++count;
  }
  if (!kept.empty()) {
    fs::remove(kept);
  }
  std::printf("%zu files, %llu changes of them, digest %016llx\n", inputs.size(),
              static_cast<unsigned long long>(count),
              static_cast<unsigned long long>(digest_of_all_results()));
  return 0;
}

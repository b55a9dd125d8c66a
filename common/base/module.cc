#include "common/base/module.h"

#include <dlfcn.h>
#include <elf.h>
#include <link.h>

#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

namespace pangaea {
namespace {

namespace fs = std::filesystem;

std::string LatestError() {
  const char* text = dlerror();
  return text == nullptr ? "no reason given" : text;
}

template <typename T>
bool ReadAt(std::ifstream& file, std::uint64_t offset, T& value) {
  file.seekg(static_cast<std::streamoff>(offset));
  return static_cast<bool>(file.read(reinterpret_cast<char*>(&value), sizeof(value)));
}

// dlopen maps the segments of a library without asking whether the file reaches so far, and dies where it does not.
bool IsWholeLibrary(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  ElfW(Ehdr) header{};
  if (error || !ReadAt(file, 0, header) || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) return false;
  for (int i = 0; i < header.e_phnum; ++i) {
    ElfW(Phdr) segment{};
    if (!ReadAt(file, header.e_phoff + static_cast<std::uint64_t>(i) * header.e_phentsize, segment)) return false;
    if (segment.p_offset > size || segment.p_filesz > size - segment.p_offset) return false;
  }
  return true;
}

}  // namespace

fs::path ModuleFolder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return program.parent_path().parent_path() / "lib";
}

Result<const void*> OpenModuleTable(const fs::path& path, const char* symbol, int version) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    return Fail(ErrorCode::kNotFound, path.string() + ": there is no such module of the program");
  }
  if (!IsWholeLibrary(path)) {
    return Fail(ErrorCode::kUnsupported, path.string() + ": the module cannot be opened: not a whole shared library");
  }
  // Lazily: of the libraries behind it a run calls a small part. And unseen by others: none is to find its names there.
  void* module = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (module == nullptr) {
    return Fail(ErrorCode::kUnsupported, path.string() + ": the module cannot be opened: " + LatestError());
  }
  const void* table = dlsym(module, symbol);
  if (table == nullptr) {
    return Fail(ErrorCode::kUnsupported, path.string() + ": not the module that it should be: it has no " + symbol);
  }
  const int found = *static_cast<const int*>(table);
  if (found == version) return table;
  return Fail(ErrorCode::kUnsupported, path.string() + ": the module has version " + std::to_string(found) +
                                           ", the program needs version " + std::to_string(version) +
                                           "; both have to come from one build");
}

}  // namespace pangaea

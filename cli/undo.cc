#include "cli/undo.h"

#include <chrono>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "cli/undo_request.h"
#include "server/storage/undo.h"

namespace pangaea {
namespace {

struct UndoOptions {
  std::vector<std::string> cause;  // words
  std::string store;
  UndoServer server;
  bool list = false;
};

std::string Join(const std::vector<std::string>& words, const char* between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

std::int64_t Now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

Status List(const UndoOptions& options) {
  auto store = Store::OpenReadOnly(options.store);
  if (!store) return tl::make_unexpected(store.error());
  const auto causes = ListCauses(*store);
  if (!causes) return tl::make_unexpected(causes.error());
  if (causes->empty()) std::cout << "the journal has no edits of the server's own\n";
  for (const JournaledCause& cause : *causes) {
    std::cout << cause.cause << (cause.undone ? "  undone" : cause.reachable ? "" : "  out of reach") << "\n";
  }
  return {};
}

Status UndoInStore(const UndoOptions& options) {
  const auto reader = Store::OpenReadOnly(options.store);
  if (!reader) return tl::make_unexpected(reader.error());
  auto store = Store::Open(options.store, reader->site(), {});
  if (!store) return tl::make_unexpected(store.error());
  const std::string cause = Join(options.cause, " ");
  const auto report = UndoCause(*store, cause, Now());
  if (!report) return tl::make_unexpected(report.error());
  std::cout << Describe(cause, *report) << "\n";
  return {};
}

Status UndoAtServer(const UndoOptions& options) {
  const auto answer = AskToUndo(Join(options.cause, " "), options.server);
  if (!answer) return tl::make_unexpected(answer.error());
  if (!answer->done) return Fail(ErrorCode::kRefused, "the server says: " + answer->text);
  std::cout << answer->text << "\n";
  return {};
}

Status Run(const UndoOptions& options) {
  if (options.store.empty() == options.server.site.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "give either --site of a running server, or --store");
  }
  if (options.list && options.store.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--list reads a --store; a server may have it open");
  }
  if (options.list) return List(options);
  if (options.cause.empty()) return Fail(ErrorCode::kInvalidArgument, "name a cause, or --list them");
  return options.store.empty() ? UndoAtServer(options) : UndoInStore(options);
}

CommandBody Declare(CLI::App& app) {
  auto options = std::make_shared<UndoOptions>();
  app.add_option("cause", options->cause, "What to take back, as the status and events call it: merge 17");
  app.add_option("--site", options->server.site, "Site of the running server that is to do it");
  app.add_option("--domain", options->server.domain.id, "DDS domain, 0 to 230")->capture_default_str();
  app.add_option("--timeout", options->server.timeout_seconds,
                 "Seconds to wait for the server and its answer (0.1 to 3600)")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 3600.0));
  app.add_option("--store", options->store, "File that holds the atlas; to undo, no server may have it open");
  app.add_flag("--list", options->list, "List what the journal has, while a server runs or not");
  app.footer(
      "The atlas is rebuilt without it: from the newest snapshot before it and the journal since. What the server "
      "built\n"
      "on it later goes with it; maps taken apart are not merged again.\n"
      "  pangaea undo merge 17 --site lab\n"
      "  pangaea undo merge 17 --store atlas.db");
  return [options] { return Run(*options); };
}

}  // namespace

Command UndoCommand() { return {"undo", "Take back a merge or loop that the server made", Declare}; }

}  // namespace pangaea

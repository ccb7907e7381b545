#pragma once
// The commands and options of a program: what is declared here is parsed, checked and printed as help by CLI11, which
// lives in command_line.cpp and nowhere else.

#include "io/keys.hpp"

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace kerf {

/// What a command takes. Names are "-o,--output" or, of what stands without a name, "CASE"; `text` is its line of help.
/// The targets must outlive the parsing.
class CommandOptions {
 public:
  explicit CommandOptions(CLI::App& app) : app_(&app) {}

  void flag(const std::string& name, bool& target, const std::string& text);
  void words(const std::string& name, std::string& target, const std::string& text, bool required = false);
  void one_of(const std::string& name, std::string& target, const std::string& text,
              const std::vector<std::string>& known);
  void number(const std::string& name, int& target, const std::string& text, std::array<int, 2> range);
  void number(const std::string& name, double& target, const std::string& text, std::array<double, 2> range);
  /// May be repeated; one value each time. `type` stands for the value in the help.
  void several(const std::string& name, std::vector<std::string>& target, const std::string& text,
               const std::string& type = {}, bool required = false);

 private:
  CLI::App* app_;
};

class CommandLine {
 public:
  CommandLine(const std::string& description, const std::string& name, const std::string& footer);
  ~CommandLine();

  /// What --version prints; asked for only then.
  void version(std::function<std::string()> text);
  /// The options of the program itself.
  CommandOptions options();
  /// One more command; `chosen` is called when it was given.
  CommandOptions command(const std::string& name, const std::string& description, std::function<void()> chosen);

  /// False when help or the version was asked for and has been printed. Throws Error(Usage); messages about a command
  /// begin with `prefix` or, where that is empty, with the command's name.
  bool parse(int argc, char** argv, const std::string& prefix = {});

  /// All commands, each with its long options.
  std::vector<CommandWords> commands() const;
  std::string help() const;

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace kerf

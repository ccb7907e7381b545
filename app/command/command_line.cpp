// Commands and options of a program, by CLI11.

#include "app/command_line.hpp"

#include "app/program.hpp"

#include <CLI/CLI.hpp>

namespace kerf {

namespace {

/// CLI11's own way would be as many values as follow.
CLI::Option* one_value_each(CLI::Option* option) {
  return option->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)->allow_extra_args(false);
}

}  // namespace

void CommandOptions::flag(const std::string& name, bool& target, const std::string& text) {
  app_->add_flag(name, target, text);
}

void CommandOptions::words(const std::string& name, std::string& target, const std::string& text, bool required) {
  app_->add_option(name, target, text)->required(required);
}

void CommandOptions::one_of(const std::string& name, std::string& target, const std::string& text,
                            const std::vector<std::string>& known) {
  app_->add_option(name, target, text)->check(CLI::IsMember(known));
}

void CommandOptions::number(const std::string& name, int& target, const std::string& text, std::array<int, 2> range) {
  app_->add_option(name, target, text)->check(CLI::Range(range[0], range[1]));
}

void CommandOptions::number(const std::string& name, double& target, const std::string& text,
                            std::array<double, 2> range) {
  app_->add_option(name, target, text)->check(CLI::Range(range[0], range[1]));
}

void CommandOptions::several(const std::string& name, std::vector<std::string>& target, const std::string& text,
                             const std::string& type, bool required) {
  CLI::Option* option = one_value_each(app_->add_option(name, target, text)->required(required));
  if (!type.empty()) option->type_name(type);
}

CommandLine::CommandLine(const std::string& description, const std::string& name, const std::string& footer)
    : app_(std::make_unique<CLI::App>(description, name)) {
  app_->footer(footer);
}

CommandLine::~CommandLine() = default;

void CommandLine::version(std::function<std::string()> text) {
  app_->set_version_flag("--version", std::move(text));
}

CommandOptions CommandLine::options() {
  return CommandOptions(*app_);
}

CommandOptions CommandLine::command(const std::string& name, const std::string& description,
                                    std::function<void()> chosen) {
  app_->require_subcommand(0, 1);
  CLI::App* sub = app_->add_subcommand(name, description);
  sub->callback(std::move(chosen));
  return CommandOptions(*sub);
}

bool CommandLine::parse(int argc, char** argv, const std::string& prefix) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) {
      app_->exit(e);
      return false;
    }
    const auto parsed = app_->get_subcommands();
    refuse_arguments(e.what(), parsed.empty() ? prefix : parsed.front()->get_name() + " ");
  }
  return true;
}

std::vector<CommandWords> CommandLine::commands() const {
  std::vector<CommandWords> all;
  for (const CLI::App* sub : app_->get_subcommands({})) {
    all.push_back({sub->get_name(), {}});
    for (const CLI::Option* option : sub->get_options())
      for (const std::string& name : option->get_lnames()) all.back().options.push_back("--" + name);
  }
  return all;
}

std::string CommandLine::help() const {
  return app_->help();
}

}  // namespace kerf

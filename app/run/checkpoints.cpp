// Checkpoints of a run. That of growth holds the states that were solved, as one vector of numbers: growth goes through
// its steps again with them, and solves on where they end. Notes of intervals are texts, by their numbers.

#include "app/run/checkpoints.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace kerf {

namespace fs = std::filesystem;

fs::path checkpoint_file(const fs::path& folder) {
  return folder / "checkpoint.bin";
}

fs::path growth_checkpoint_file(const fs::path& folder) {
  return folder / "checkpoint.growth.bin";
}

bool has_checkpoint(const fs::path& folder) {
  return fs::exists(checkpoint_file(folder)) || fs::exists(growth_checkpoint_file(folder));
}

void check_checkpoint(const fs::path& folder, const std::string& fingerprint) {
  for (const fs::path& path : {checkpoint_file(folder), growth_checkpoint_file(folder)}) {
    const auto found = read_checkpoint(path);
    if (found && found->fingerprint != fingerprint)
      throw Error(Fault::Usage,
                  fmt::format("the checkpoint {} belongs to another case: the case file or an override has "
                              "changed; restore it, or start without --resume",
                              path.string()));
  }
}

namespace {

/// Writes or reads numbers and texts one after the other: who goes through a record writes its order once.
class Archive {
 public:
  Archive() = default;
  explicit Archive(const Checkpoint& from) : reading_(true), texts_(from.texts) {
    const auto found = from.numbers.find("states");
    if (found == from.numbers.end()) refuse();
    numbers_.assign(found->second.begin(), found->second.end());
  }
  void number(double& value) {
    if (!reading_) {
      numbers_.push_back(value);
      return;
    }
    if (at_ == numbers_.size()) refuse();
    value = numbers_[at_++];
  }
  template <typename Whole>
  void whole(Whole& value) {
    auto as_number = static_cast<double>(value);
    number(as_number);
    if (!reading_) return;
    constexpr double most = 1e9;
    if (!(as_number >= 0 && as_number <= most) || as_number != std::floor(as_number)) refuse();
    value = static_cast<Whole>(as_number);
  }
  void text(std::string& value) {
    const std::string name = std::to_string(texts_seen_++);
    if (!reading_) {
      texts_[name] = value;
      return;
    }
    const auto found = texts_.find(name);
    if (found == texts_.end()) refuse();
    value = found->second;
  }
  /// Its length and its members.
  template <typename Of, typename Member>
  void sequence(std::vector<Of>& of, const Member& member) {
    std::size_t count = of.size();
    whole(count);
    if (reading_ && count > numbers_.size() - at_) refuse();
    of.resize(count);
    for (Of& each : of) member(each);
  }
  Checkpoint checkpoint() const {
    Checkpoint out;
    out.numbers["states"] =
        Eigen::Map<const Eigen::VectorXd>(numbers_.data(), static_cast<Eigen::Index>(numbers_.size()));
    out.texts = texts_;
    return out;
  }

 private:
  [[noreturn]] static void refuse() {
    throw Error(Fault::Files, "the checkpoint of growth does not hold the states of one; start without --resume");
  }
  bool reading_ = false;
  std::vector<double> numbers_;
  std::size_t at_ = 0, texts_seen_ = 0;
  std::map<std::string, std::string> texts_;
};

void go_through(Archive& a, Interval& i) {
  a.number(i.low);
  a.number(i.high);
}
void go_through(Archive& a, TipIntensity& t) {
  a.whole(t.crack);
  a.whole(t.at_start);
  a.whole(t.on_border);
  Index region = t.region + 1;  // none: 0
  a.whole(region);
  t.region = region - 1;
  for (double* value : {&t.at.x(), &t.at.y(), &t.K_I, &t.K_II, &t.T, &t.G, &t.J, &t.radius, &t.spread, &t.spread_K_I,
                        &t.spread_K_II, &t.spread_T})
    a.number(*value);
}
void go_through(Archive& a, growth::StateBounds& b) {
  go_through(a, b.energy);
  a.whole(b.guaranteed);
  a.text(b.note);
  a.sequence(b.tips, [&](growth::TipIntervals& t) {
    a.whole(t.end.crack);
    a.whole(t.end.at_start);
    for (Interval* i : {&t.K_I, &t.K_II, &t.G}) go_through(a, *i);
    a.whole(t.guaranteed);
    a.text(t.note);
  });
}
void go_through(Archive& a, growth::GrowthRecord& record) {
  a.whole(record.told);
  a.sequence(record.states, [&](growth::SolvedState& s) {
    a.number(s.potential);
    a.number(s.strain);
    a.number(s.resting);
    a.sequence(s.tips, [&](TipIntensity& t) { go_through(a, t); });
    bool bounded = s.bounds.has_value();
    a.whole(bounded);
    if (bounded && !s.bounds) s.bounds.emplace();
    if (bounded) go_through(a, *s.bounds);
  });
}

}  // namespace

Checkpoint as_checkpoint(const growth::GrowthRecord& record) {
  Archive a;
  growth::GrowthRecord copy = record;
  go_through(a, copy);
  return a.checkpoint();
}

growth::GrowthRecord growth_record(const Checkpoint& checkpoint) {
  Archive a(checkpoint);
  growth::GrowthRecord record;
  go_through(a, record);
  return record;
}

}  // namespace kerf

#pragma once
// Results as JSON and CSV, and the JSON lines of other programs. In this room nlohmann-json lives in records.cpp.

#include "bench/hard.hpp"
#include "bench/measure/contact.hpp"
#include "bench/measure/limit.hpp"
#include "bench/measure/machines.hpp"
#include "bench/measure/map.hpp"
#include "bench/measure/proof.hpp"
#include "bench/measure/state.hpp"
#include "bench/optimize/optimize.hpp"

namespace kerf {

void write_state_csv(const std::filesystem::path& path, const StateBench& bench);
void write_state_json(const std::filesystem::path& path, const StateBench& bench);
void write_map_csv(const std::filesystem::path& path, const MapBench& bench);
void write_validation_csv(const std::filesystem::path& path, const MapBench& bench);
void write_map_json(const std::filesystem::path& path, const MapBench& bench);
void write_contact_csv(const std::filesystem::path& path, const ContactBench& bench);
void write_contact_json(const std::filesystem::path& path, const ContactBench& bench);
void write_hard_csv(const std::filesystem::path& path, const HardBench& bench);
void write_hard_json(const std::filesystem::path& path, const HardBench& bench);
void write_proof_csv(const std::filesystem::path& path, const ProofBench& bench);
void write_second_terms_csv(const std::filesystem::path& path, const ProofBench& bench);
void write_proof_json(const std::filesystem::path& path, const ProofBench& bench);
/// A row per run and phase.
void write_limit_csv(const std::filesystem::path& path, const LimitBench& bench);
void write_limit_json(const std::filesystem::path& path, const LimitBench& bench);
void write_machines_csv(const std::filesystem::path& path, const MachineBench& bench);
void write_machines_json(const std::filesystem::path& path, const MachineBench& bench);
/// The rows of such a file, none where there is none.
std::vector<MachineRow> read_machines_json(const std::filesystem::path& path);
void write_optimize_csv(const std::filesystem::path& path, const OptimizeBench& bench);
void write_optimize_spread_csv(const std::filesystem::path& path, const OptimizeBench& bench);
void write_optimize_curves_csv(const std::filesystem::path& path, const OptimizeBench& bench);
void write_optimize_json(const std::filesystem::path& path, const OptimizeBench& bench);

/// The last JSON object among the lines: nt, ndof, err_s or err_map, J, t_post, and the sum of t_mesh, t_asm, t_solve
/// and t_post. Nothing when there is none, or neither a positive error nor J in it.
std::optional<PeerRun> read_peer_line(const std::string& output);
std::string last_line(const std::string& output);

}  // namespace kerf

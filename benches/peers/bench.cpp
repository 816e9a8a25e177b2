// Times the functions of one arm, peer beside peer, and compares their values.
//
//   bench STATES ROUNDS REFERENCE=LIBRARY:PREFIX[:CHAIN] NAME=LIBRARY:PREFIX[:CHAIN] ...
//
// A peer is a shared library with the functions of an emitted C header, each named PREFIX and its name; what it has not got is left out,
// and what the first one has not got of all. One that exports `base_parameters` says how many columns their regressor has.
// A library that exports `load` is told the file CHAIN of the arm first. Prints one line of JSON for each function: nanoseconds per
// call of every peer in every round, and the error of every peer's values: from those of the reference or, where it has none, of the last peer. None is compared with its own library.
#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace {

constexpr int STATES = 64;
constexpr double BATCH_NS = 1e5;
constexpr int GUARD = 8;
const double UNWRITTEN = std::numeric_limits<double>::quiet_NaN();

enum Input { Q, DQ, DDQ, TAU, INPUTS };

using Arguments = std::vector<const double *>;
using Results = std::vector<double *>;

template <typename T, size_t>
using Each = T;

template <size_t... I, size_t... O>
void invoke(void *f, const double *const *in, double *const *out, std::index_sequence<I...>, std::index_sequence<O...>) {
  reinterpret_cast<void (*)(Each<const double *, I>..., Each<double *, O>...)>(f)(in[I]..., out[O]...);
}

// Calls a function of that many arguments and results with one state after the other; the nanoseconds that takes.
template <size_t IN, size_t OUT>
double run(void *f, const std::vector<Arguments> &states, const Results &results, long first, long calls) {
  const auto start = std::chrono::steady_clock::now();
  for (long k = first; k < first + calls; ++k) {
    invoke(f, states[k % STATES].data(), results.data(), std::make_index_sequence<IN>(), std::make_index_sequence<OUT>());
    asm volatile("" : : "r"(results.data()) : "memory");  // the results count as read, and every call as a new one
  }
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
}

using Run = double (*)(void *, const std::vector<Arguments> &, const Results &, long, long);
// Sizes of the results of an arm of n joints and b base parameters.
using Sizes = std::vector<size_t> (*)(size_t n, size_t b);

struct Function {
  const char *name;
  std::vector<Input> inputs;
  Sizes sizes;
  Run run;
};

std::vector<size_t> vector_of(size_t n, size_t) { return {n}; }
std::vector<size_t> matrix(size_t n, size_t) { return {n * n}; }
std::vector<size_t> two_matrices(size_t n, size_t) { return {n * n, n * n}; }
std::vector<size_t> three_matrices(size_t n, size_t) { return {n * n, n * n, n * n}; }

const std::vector<Function> FUNCTIONS = {
    {"direct_kinematics", {Q}, [](size_t, size_t) { return std::vector<size_t>{16}; }, run<1, 1>},
    {"geometric_jacobian", {Q}, [](size_t n, size_t) { return std::vector<size_t>{6 * n}; }, run<1, 1>},
    {"inertia_matrix", {Q}, matrix, run<1, 1>},
    {"coriolis_matrix", {Q, DQ}, matrix, run<2, 1>},
    {"gravity", {Q}, vector_of, run<1, 1>},
    {"equations_of_motion", {Q, DQ}, [](size_t n, size_t) { return std::vector<size_t>{n * n, n * n, n}; }, run<2, 3>},
    {"inverse_dynamics", {Q, DQ, DDQ}, vector_of, run<3, 1>},
    {"forward_dynamics", {Q, DQ, TAU}, vector_of, run<3, 1>},
    {"regressor", {Q, DQ, DQ, DDQ}, [](size_t n, size_t) { return std::vector<size_t>{10 * n * n}; }, run<4, 1>},
    {"base_regressor", {Q, DQ, DDQ}, [](size_t n, size_t b) { return std::vector<size_t>{n * b}; }, run<3, 1>},
    {"inverse_dynamics_derivatives", {Q, DQ, DDQ}, two_matrices, run<3, 2>},
    {"forward_dynamics_derivatives", {Q, DQ, TAU}, three_matrices, run<3, 3>},
};

[[noreturn]] void fail(const std::string &what) {
  std::cerr << "bench: " << what << "\n";
  std::exit(2);
}

struct Peer {
  std::string name, prefix;
  void *library;

  explicit Peer(const std::string &text) {
    const size_t equals = text.find('='), colon = text.find(':', equals);
    if (colon == std::string::npos) fail(text + " is not NAME=LIBRARY:PREFIX");
    const size_t chain = text.find(':', colon + 1);
    name = text.substr(0, equals);
    prefix = text.substr(colon + 1, chain == std::string::npos ? chain : chain - colon - 1);
    library = dlopen(text.substr(equals + 1, colon - equals - 1).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) fail(dlerror());
    if (void *load = dlsym(library, "load")) reinterpret_cast<void (*)(const char *)>(load)(text.substr(chain + 1).c_str());
  }
  void *function(const char *function) const { return dlsym(library, (prefix + function).c_str()); }
};

// Memory for the results of one call, each with a guard behind it.
struct Memory {
  std::vector<std::vector<double>> arrays;
  Results results;

  explicit Memory(const std::vector<size_t> &sizes) {
    for (size_t size : sizes) arrays.emplace_back(size + GUARD);
    for (auto &array : arrays) results.push_back(array.data());
  }
  void spoil() {
    for (auto &array : arrays) std::fill(array.begin(), array.end(), UNWRITTEN);
  }
  bool guards_stand() const {
    for (const auto &array : arrays)
      if (!std::all_of(array.end() - GUARD, array.end(), [](double x) { return std::isnan(x); })) return false;
    return true;
  }
};

struct States {
  size_t joints = 0, base_parameters = 0;
  std::vector<double> values[INPUTS];

  explicit States(const std::string &path) {
    std::ifstream in(path);
    in >> joints;
    for (int k = 0; k < STATES; ++k)
      for (Input input : {Q, DQ, DDQ})
        for (size_t i = 0; i < joints; ++i) values[input].emplace_back(), in >> values[input].back();
    if (!in || joints == 0) fail(path + " is not a file of states");
  }
  // Torques of the size that goes with the accelerations: those that cause them.
  void add_torques(const Peer &reference) {
    void *f = reference.function("inverse_dynamics");
    if (!f) fail("the reference has no inverse_dynamics");
    values[TAU].resize(values[Q].size());
    for (int k = 0; k < STATES; ++k) run<3, 1>(f, arguments({Q, DQ, DDQ}), {values[TAU].data() + k * joints}, k, 1);
  }
  std::vector<Arguments> arguments(const std::vector<Input> &inputs) const {
    std::vector<Arguments> result(STATES);
    for (int k = 0; k < STATES; ++k)
      for (Input input : inputs) result[k].push_back(values[input].data() + k * joints);
    return result;
  }
};

// Largest error over all states, by the largest entry of the same result; infinite if an entry is missing or too many are written.
double error(const Function &function, void *f, void *reference, const States &states) {
  const std::vector<size_t> sizes = function.sizes(states.joints, states.base_parameters);
  Memory mine(sizes), theirs(sizes);
  const auto arguments = states.arguments(function.inputs);
  std::vector<double> worst(sizes.size()), largest(sizes.size());
  for (int k = 0; k < STATES; ++k) {
    mine.spoil();
    theirs.spoil();
    function.run(f, arguments, mine.results, k, 1);
    function.run(reference, arguments, theirs.results, k, 1);
    if (!mine.guards_stand()) return INFINITY;
    for (size_t r = 0; r < sizes.size(); ++r)
      for (size_t i = 0; i < sizes[r]; ++i) {
        const double difference = std::abs(mine.arrays[r][i] - theirs.arrays[r][i]);
        if (!std::isfinite(difference)) return INFINITY;
        worst[r] = std::max(worst[r], difference);
        largest[r] = std::max(largest[r], std::abs(theirs.arrays[r][i]));
      }
  }
  double result = 0;
  for (size_t r = 0; r < sizes.size(); ++r) result = std::max(result, worst[r] / (largest[r] > 0 ? largest[r] : 1));
  return result;
}

struct Contestant {
  const Peer *peer;
  void *f;
  long batch;
  std::vector<double> ns;
};

// Calls that take about the time of a batch. By the fastest of many short runs: on a busy machine one long run is mostly other programs.
long batch(const Function &function, void *f, const std::vector<Arguments> &arguments, const Results &results) {
  double ns = INFINITY;
  for (int trial = 0; trial < 32; ++trial) ns = std::min(ns, function.run(f, arguments, results, 0, STATES));
  return std::max(1L, std::lround(STATES * BATCH_NS / ns));
}

std::vector<Contestant> race(const Function &function, const std::vector<Peer> &peers, const States &states, int rounds) {
  Memory memory(function.sizes(states.joints, states.base_parameters));
  const auto arguments = states.arguments(function.inputs);
  std::vector<Contestant> field;
  for (const Peer &peer : peers)
    if (void *f = peer.function(function.name)) field.push_back({&peer, f, batch(function, f, arguments, memory.results), {}});
  for (int round = 0; round < rounds; ++round)
    for (size_t i = 0; i < field.size(); ++i) {
      Contestant &c = field[(i + round) % field.size()];
      function.run(c.f, arguments, memory.results, round, c.batch / 8 + 1);  // its code and data come into the caches
      c.ns.push_back(function.run(c.f, arguments, memory.results, round, c.batch) / c.batch);
    }
  return field;
}

void print(const Function &function, const std::vector<Contestant> &field, const Peer &first, const States &states) {
  // What the reference has not got is compared with the last peer that has it.
  const bool referred = first.function(function.name) != nullptr;
  const Peer &reference = referred || field.empty() ? first : *field.back().peer;
  void *expected = reference.function(function.name);
  std::printf("{\"function\": \"%s\", \"peers\": {", function.name);
  for (size_t i = 0; i < field.size(); ++i) {
    const Contestant &c = field[i];
    std::printf("%s\"%s\": {\"ns\": [", i ? ", " : "", c.peer->name.c_str());
    for (size_t k = 0; k < c.ns.size(); ++k) std::printf("%s%.3f", k ? ", " : "", c.ns[k]);
    std::printf("]");
    if (expected && c.peer->library != reference.library) {
      const double e = error(function, c.f, expected, states);
      // JSON has no infinity; a number that no float holds is read as one.
      std::isfinite(e) ? std::printf(", \"error\": %.3e", e) : std::printf(", \"error\": 1e999");
    }
    std::printf("}");
  }
  std::printf("}}\n");
  std::fflush(stdout);
}

}  // namespace

int main(int count, char **values) {
  if (count < 5) fail("bench STATES ROUNDS REFERENCE=LIBRARY:PREFIX[:CHAIN] NAME=LIBRARY:PREFIX[:CHAIN] ...");
  const Peer reference(values[3]);
  const std::vector<Peer> peers(values + 4, values + count);
  States states(values[1]);
  states.add_torques(reference);
  for (const Peer &peer : peers)
    if (void *count = peer.function("base_parameters")) states.base_parameters = reinterpret_cast<int (*)()>(count)();
  for (const Function &function : FUNCTIONS)
    if (peers.front().function(function.name))
      print(function, race(function, peers, states, std::atoi(values[2])), reference, states);
}

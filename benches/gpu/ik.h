/* The rows that both sides write of a pose: verdict, count, miss, then the joint variables of all postures. */
#include <cstddef>

#define JOINED_(a, b) a##b
#define JOINED(a, b) JOINED_(a, b)
#define OF(name) JOINED(ROBOT, name)

typedef REAL Real;
constexpr int WRITTEN = 3 + MOST * DOF;

/* The poses of random postures, and their postures: poses by entry, with the redundancy behind them. */
void host_poses(size_t begin, size_t end, size_t leading, const Real *q, Real *poses);
void host_ik(size_t begin, size_t end, size_t leading, const Real *poses, Real *rows);

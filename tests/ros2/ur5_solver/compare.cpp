// Loads the plugin, and compares it with KDL at 1e5 states: largest differences, each scaled by the largest entry of all states.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <pluginlib/class_loader.hpp>
#include <random>

static long allocations = 0;
extern "C" void * __libc_malloc(size_t size);
extern "C" void * malloc(size_t size)
{
  ++allocations;
  return __libc_malloc(size);
}

// robots/ur5.yaml: rows of Denavit and Hartenberg, masses, centres of mass, and inertias xx, yy, zz about these, in the frames of the links.
static const double ARM[6][11] = {
  {0, -M_PI_2, 0.089159, 0, 3.7, 0, 0, 0, 0.010267496, 0.00666, 0.010267496},
  {0.425, 0, 0, 0, 8.393, -0.145, 0, 0.13585, 0.0151074, 0.226890676, 0.226890676},
  {0.39225, 0, 0, 0, 2.275, -0.14225, 0, 0.01615, 0.004095, 0.049443314, 0.049443314},
  {0, -M_PI_2, 0.10915, 0, 1.219, 0, 0.093, 0, 0.111172756, 0.111172756, 0.21942},
  {0, M_PI_2, 0.09465, 0, 1.219, 0, -0.09465, 0, 0.111172756, 0.21942, 0.111172756},
  {0, 0, 0.0823, 0, 0.1879, 0, 0, -0.0823, 0.017136473, 0.033822, 0.017136473},
};

static KDL::Chain chain()
{
  KDL::Chain chain;
  for (const auto & row : ARM) {
    const KDL::RigidBodyInertia body(
      row[4], KDL::Vector(row[5], row[6], row[7]), KDL::RotationalInertia(row[8], row[9], row[10]));
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame::DH(row[0], row[1], row[2], row[3]), body));
  }
  return chain;
}

struct Difference
{
  double difference = 0, largest = 0;
  template <class A, class B>
  void add(const A & ours, const B & theirs)
  {
    difference = std::max(difference, (ours - theirs).cwiseAbs().maxCoeff());
    largest = std::max(largest, theirs.cwiseAbs().maxCoeff());
  }
  bool small(const char * name) const
  {
    std::printf("%-14s %.1e\n", name, difference / largest);
    return difference <= 1e-12 * largest;
  }
};

int main()
{
  pluginlib::ClassLoader<inverse_dynamics_solver::InverseDynamicsSolver> loader(
    "inverse_dynamics_solver", "inverse_dynamics_solver::InverseDynamicsSolver");
  const auto solver = loader.createUniqueInstance("ur5_solver/Ur5Solver");
  solver->initialize();

  const KDL::Chain arm = chain();
  KDL::ChainDynParam kdl(arm, KDL::Vector(0, 0, -9.81));
  KDL::JntArray q(6), dq(6), coriolis(6), gravity(6);
  KDL::JntSpaceInertiaMatrix inertia(6);
  Eigen::VectorXd ddq(6);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(-M_PI, M_PI), rate(-3, 3);
  Difference of_inertia, of_coriolis, of_gravity, of_torques, of_all;
  long most = 0;
  for (int state = 0; state < 100000; ++state) {
    for (int i = 0; i < 6; ++i) {
      q(i) = angle(random);
      dq(i) = rate(random);
      ddq(i) = rate(random);
    }
    kdl.JntToMass(q, inertia);
    kdl.JntToCoriolis(q, dq, coriolis);
    kdl.JntToGravity(q, gravity);
    of_inertia.add(solver->getInertiaMatrix(q.data), inertia.data);
    of_coriolis.add(solver->getCoriolisVector(q.data, dq.data), coriolis.data);
    of_gravity.add(solver->getGravityVector(q.data), gravity.data);
    const auto [b, c, g] = solver->getDynamicParameters(q.data, dq.data);
    of_all.add(Eigen::VectorXd(b * ddq + c + g), Eigen::VectorXd(inertia.data * ddq + coriolis.data + gravity.data));
    const long before = allocations;
    const Eigen::VectorXd torques = solver->getTorques(q.data, dq.data, ddq);
    most = std::max(most, allocations - before);
    of_torques.add(torques, Eigen::VectorXd(inertia.data * ddq + coriolis.data + gravity.data));
  }
  const bool small = of_inertia.small("inertia") & of_coriolis.small("Coriolis") & of_gravity.small("gravity") &
                     of_all.small("all at once") & of_torques.small("torques");
  std::printf("allocations    %ld in a call of getTorques, of its result\n", most);
  return small && most == 1 && solver->getFrictionVector(dq.data).isZero() ? 0 : 1;
}

// The solver of a UR5 by the functions of its package: torques, and what they consist of.
//
// To take it for another arm, generate its package and replace `ur5` and `UR5`.
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <ur5_armgen/ur5.h>

namespace ur5_solver
{
class Ur5Solver : public inverse_dynamics_solver::InverseDynamicsSolver
{
public:
  // The arm is compiled in: neither parameters nor a description are read.
  void initialize(
    rclcpp::node_interfaces::NodeParametersInterface::ConstSharedPtr, const std::string &, const std::string &) override
  {
  }

  Eigen::MatrixXd getInertiaMatrix(const Vector & q) const override
  {
    Matrix b;
    ur5_inertia_matrix(entries(q), rows(b));
    return b;
  }

  Vector getCoriolisVector(const Vector & q, const Vector & dq) const override
  {
    Matrix c;
    ur5_coriolis_matrix(entries(q), entries(dq), rows(c));
    return c * joints(dq);
  }

  Vector getGravityVector(const Vector & q) const override
  {
    Vector g(UR5_DOF);
    ur5_gravity(entries(q), g.data());
    return g;
  }

  Vector getFrictionVector(const Vector & dq) const override
  {
    Vector f(UR5_DOF);
    ur5_friction(entries(dq), f.data());
    return f;
  }

  std::tuple<Eigen::MatrixXd, Vector, Vector> getDynamicParameters(const Vector & q, const Vector & dq) const override
  {
    Matrix b, c;
    Vector g(UR5_DOF);
    ur5_equations_of_motion(entries(q), entries(dq), rows(b), rows(c), g.data());
    return {b, c * joints(dq), g};
  }

  // The function has friction in it, the interface has not.
  Vector getTorques(const Vector & q, const Vector & dq, const Vector & ddq) const override
  {
    Vector tau(UR5_DOF);
    Joints friction;
    ur5_inverse_dynamics(entries(q), entries(dq), entries(ddq), tau.data());
    ur5_friction(entries(dq), friction.data());
    tau -= friction;
    return tau;
  }

private:
  using Matrix = Eigen::Matrix<double, UR5_DOF, UR5_DOF, Eigen::RowMajor>;
  using Joints = Eigen::Matrix<double, UR5_DOF, 1>;
  using Rows = double (*)[UR5_DOF];

  static Rows rows(Matrix & matrix) { return reinterpret_cast<Rows>(matrix.data()); }

  static const double * entries(const Vector & vector)
  {
    if (vector.size() != UR5_DOF) throw std::invalid_argument("ur5_solver: a vector has not an entry for each of the 6 joints");
    return vector.data();
  }

  static Eigen::Map<const Joints> joints(const Vector & vector) { return Eigen::Map<const Joints>(entries(vector)); }
};
}  // namespace ur5_solver

PLUGINLIB_EXPORT_CLASS(ur5_solver::Ur5Solver, inverse_dynamics_solver::InverseDynamicsSolver)

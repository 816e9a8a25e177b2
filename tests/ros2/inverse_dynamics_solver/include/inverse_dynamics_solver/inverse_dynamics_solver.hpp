// A twin of the interface inverse_dynamics_solver of ROS 2: the same names and types, written anew.
#pragma once
#include <Eigen/Core>
#include <rclcpp/node_interfaces/node_parameters_interface.hpp>
#include <string>
#include <tuple>

namespace inverse_dynamics_solver
{
class InverseDynamicsSolver
{
public:
  using Vector = Eigen::VectorXd;
  virtual ~InverseDynamicsSolver() = default;
  virtual void initialize(
    rclcpp::node_interfaces::NodeParametersInterface::ConstSharedPtr parameters = nullptr,
    const std::string & parameter_namespace = "", const std::string & robot_description = "") = 0;
  /// Inertia matrix, C(q, dq) dq, and gravity.
  virtual std::tuple<Eigen::MatrixXd, Vector, Vector> getDynamicParameters(const Vector & q, const Vector & dq) const
  {
    return {getInertiaMatrix(q), getCoriolisVector(q, dq), getGravityVector(q)};
  }
  virtual Eigen::MatrixXd getInertiaMatrix(const Vector & q) const = 0;
  virtual Vector getCoriolisVector(const Vector & q, const Vector & dq) const = 0;
  virtual Vector getGravityVector(const Vector & q) const = 0;
  virtual Vector getFrictionVector(const Vector & dq) const = 0;
  /// Torques without friction.
  virtual Vector getTorques(const Vector & q, const Vector & dq, const Vector & ddq) const
  {
    return getInertiaMatrix(q) * ddq + getCoriolisVector(q, dq) + getGravityVector(q);
  }

protected:
  InverseDynamicsSolver() = default;
};
}  // namespace inverse_dynamics_solver

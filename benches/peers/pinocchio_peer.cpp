// Pinocchio with the functions of an emitted C header.
//
// Each function is there twice. `call_NAME` is the library's call alone, its results left where the library puts them
// (pinocchio::Data; of symmetric matrices one triangle): what a C++ program pays. `reference_NAME` then writes what the C header
// promises, full matrices by rows: what the others are judged by. Arms are chains of joints about or along z, as model.py writes them.
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>

namespace pin = pinocchio;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Parameters = Eigen::Matrix<double, 10, 10, Eigen::RowMajor>;

template <typename Matrix>
void read(std::istream &in, Matrix &m) {
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.cols(); ++j) in >> m(i, j);
}

pin::SE3 read_frame(std::istream &in) {
  Matrix3d rotation;
  Vector3d origin;
  read(in, rotation);
  read(in, origin);
  return pin::SE3(rotation, origin);
}

struct Arm {
  pin::Model model;
  std::unique_ptr<pin::Data> data;
  pin::FrameIndex end_effector = 0;
  // The library's own types, for which its functions are compiled already; maps over the caller's arrays are not among them.
  VectorXd q, dq, third;
  pin::Data::Matrix6x jacobian;
  std::vector<Parameters> joint_from_link;

  explicit Arm(std::istream &in) {
    int joints = 0;
    Vector3d gravity;
    in >> joints;
    read(in, gravity);
    model.gravity.linear(gravity);
    pin::JointIndex last = 0;
    for (int i = 0; i < joints; ++i) last = add_joint(in, last, i);
    end_effector = model.addFrame(pin::Frame("end effector", last, 0, read_frame(in), pin::OP_FRAME));
    if (!in) throw std::runtime_error("the chain's file ends too early");
    data = std::make_unique<pin::Data>(model);
    q = dq = third = VectorXd::Zero(joints);
    jacobian = pin::Data::Matrix6x::Zero(6, joints);
  }

  pin::JointIndex add_joint(std::istream &in, pin::JointIndex parent, int i) {
    std::string kind;
    in >> kind;
    const pin::SE3 placement = read_frame(in);
    const std::string name = "joint" + std::to_string(i + 1);
    const pin::JointIndex joint = kind == "revolute" ? model.addJoint(parent, pin::JointModelRZ(), placement, name)
                                                     : model.addJoint(parent, pin::JointModelPZ(), placement, name);
    double mass = 0;
    Vector3d com;
    Matrix3d inertia;
    Parameters map;
    in >> mass;
    read(in, com);
    read(in, inertia);
    read(in, map);
    model.appendBodyToJoint(joint, pin::Inertia(mass, com, inertia), pin::SE3::Identity());
    joint_from_link.push_back(map);
    return joint;
  }
};

std::unique_ptr<Arm> arm;

void set(VectorXd &to, const double *from) { to = Eigen::Map<const VectorXd>(from, to.size()); }

template <typename Matrix>
void store(double *to, const Matrix &m) {
  Eigen::Map<ByRows>(to, m.rows(), m.cols()) = m;
}

void store_symmetric(double *to, const MatrixXd &upper) { store(to, MatrixXd(upper.selfadjointView<Eigen::Upper>())); }

}  // namespace

extern "C" {

void load(const char *chain) {
  std::ifstream in(chain);
  arm = std::make_unique<Arm>(in);
}

void call_direct_kinematics(const double *q, double *) {
  set(arm->q, q);
  pin::forwardKinematics(arm->model, *arm->data, arm->q);
  pin::updateFramePlacement(arm->model, *arm->data, arm->end_effector);
}
void reference_direct_kinematics(const double *q, double *t) {
  call_direct_kinematics(q, nullptr);
  store(t, arm->data->oMf[arm->end_effector].toHomogeneousMatrix());
}

void call_geometric_jacobian(const double *q, double *) {
  set(arm->q, q);
  pin::computeJointJacobians(arm->model, *arm->data, arm->q);
  pin::updateFramePlacement(arm->model, *arm->data, arm->end_effector);
  pin::getFrameJacobian(arm->model, *arm->data, arm->end_effector, pin::LOCAL_WORLD_ALIGNED, arm->jacobian);
}
void reference_geometric_jacobian(const double *q, double *j) {
  call_geometric_jacobian(q, nullptr);
  store(j, arm->jacobian);
}

void call_inertia_matrix(const double *q, double *) {
  set(arm->q, q);
  pin::crba(arm->model, *arm->data, arm->q, pin::Convention::LOCAL);
}
void reference_inertia_matrix(const double *q, double *b) {
  call_inertia_matrix(q, nullptr);
  store_symmetric(b, arm->data->M);
}

void call_coriolis_matrix(const double *q, const double *dq, double *) {
  set(arm->q, q);
  set(arm->dq, dq);
  pin::computeCoriolisMatrix(arm->model, *arm->data, arm->q, arm->dq);
}
void reference_coriolis_matrix(const double *q, const double *dq, double *c) {
  call_coriolis_matrix(q, dq, nullptr);
  store(c, arm->data->C);
}

void call_gravity(const double *q, double *) {
  set(arm->q, q);
  pin::computeGeneralizedGravity(arm->model, *arm->data, arm->q);
}
void reference_gravity(const double *q, double *g) {
  call_gravity(q, nullptr);
  store(g, arm->data->g);
}

// The library has no call for exactly these three (computeAllTerms is more, and without C).
void call_equations_of_motion(const double *q, const double *dq, double *, double *, double *) {
  call_inertia_matrix(q, nullptr);
  call_coriolis_matrix(q, dq, nullptr);
  call_gravity(q, nullptr);
}
void reference_equations_of_motion(const double *q, const double *dq, double *b, double *c, double *g) {
  reference_inertia_matrix(q, b);
  reference_coriolis_matrix(q, dq, c);
  reference_gravity(q, g);
}

void call_inverse_dynamics(const double *q, const double *dq, const double *ddq, double *) {
  set(arm->q, q);
  set(arm->dq, dq);
  set(arm->third, ddq);
  pin::rnea(arm->model, *arm->data, arm->q, arm->dq, arm->third);
}
void reference_inverse_dynamics(const double *q, const double *dq, const double *ddq, double *tau) {
  call_inverse_dynamics(q, dq, ddq, nullptr);
  store(tau, arm->data->tau);
}

void call_forward_dynamics(const double *q, const double *dq, const double *tau, double *) {
  set(arm->q, q);
  set(arm->dq, dq);
  set(arm->third, tau);
  pin::aba(arm->model, *arm->data, arm->q, arm->dq, arm->third);
}
void reference_forward_dynamics(const double *q, const double *dq, const double *tau, double *ddq) {
  call_forward_dynamics(q, dq, tau, nullptr);
  store(ddq, arm->data->ddq);
}

// The library's regressor has one rate only: dqr = dq.
void call_regressor(const double *q, const double *dq, const double *, const double *ddqr, double *) {
  set(arm->q, q);
  set(arm->dq, dq);
  set(arm->third, ddqr);
  pin::computeJointTorqueRegressor(arm->model, *arm->data, arm->q, arm->dq, arm->third);
}
// Its columns are those of the joint frames' parameters; the map turns them into those of the link frames.
void reference_regressor(const double *q, const double *dq, const double *dqr, const double *ddqr, double *y) {
  call_regressor(q, dq, dqr, ddqr, nullptr);
  MatrixXd columns = arm->data->jointTorqueRegressor;
  for (size_t i = 0; i < arm->joint_from_link.size(); ++i)
    columns.middleCols(10 * i, 10) = (columns.middleCols(10 * i, 10) * arm->joint_from_link[i]).eval();
  store(y, columns);
}

void call_inverse_dynamics_derivatives(const double *q, const double *dq, const double *ddq, double *, double *) {
  set(arm->q, q);
  set(arm->dq, dq);
  set(arm->third, ddq);
  pin::computeRNEADerivatives(arm->model, *arm->data, arm->q, arm->dq, arm->third);
}
void reference_inverse_dynamics_derivatives(const double *q, const double *dq, const double *ddq, double *by_q, double *by_dq) {
  call_inverse_dynamics_derivatives(q, dq, ddq, nullptr, nullptr);
  store(by_q, arm->data->dtau_dq);
  store(by_dq, arm->data->dtau_dv);
}

void call_forward_dynamics_derivatives(const double *q, const double *dq, const double *tau, double *, double *, double *) {
  set(arm->q, q);
  set(arm->dq, dq);
  set(arm->third, tau);
  pin::computeABADerivatives(arm->model, *arm->data, arm->q, arm->dq, arm->third);
}
void reference_forward_dynamics_derivatives(const double *q, const double *dq, const double *tau, double *by_q, double *by_dq,
                                            double *by_tau) {
  call_forward_dynamics_derivatives(q, dq, tau, nullptr, nullptr, nullptr);
  store(by_q, arm->data->ddq_dq);
  store(by_dq, arm->data->ddq_dv);
  store_symmetric(by_tau, arm->data->Minv);
}

}  // extern "C"

/*
 * Laws of control for the joints: hand guiding and impedance. Compensation of gravity alone is robot_gravity.
 *
 * Each call takes one sample and writes the torques to hold until the next, tau, N m or N. It allocates nothing, and keeps nothing but the
 * anchor, which is the caller's. On a fault it leaves tau and anchor as they were. Gains are copied; NULL leaves a part of a law out.
 */
#ifdef __cplusplus
extern "C" {
#endif

/* What a law answers. */
enum {
    ROBOT_LAW_OK = 0,
    ROBOT_LAW_GAINS = 1,       /* a gain is not finite, or not positive */
    ROBOT_LAW_MEASUREMENT = 2, /* q or dq is not finite: the sensor has failed */
    ROBOT_LAW_REFERENCE = 3,   /* the pose, its velocity or acceleration is not finite */
    ROBOT_LAW_TORQUE = 4,      /* the torque is not finite: gains are beyond the range of the scalar */
    ROBOT_LAW_INERTIA = 5,     /* the inertia matrix is not positive definite */
    ROBOT_LAW_OTHER = 6
};

/* Springs, N m/rad or N/m, and dampers, N m s/rad or N s/m, within a width of the limits of the joints, rad or m. */
typedef struct {
    robot_real lower[ROBOT_DOF], upper[ROBOT_DOF], width[ROBOT_DOF], stiffness[ROBOT_DOF], damping[ROBOT_DOF];
} robot_walls;

/* Dampers beyond a rate of each joint, rad/s or m/s. */
typedef struct {
    robot_real rate[ROBOT_DOF], damping[ROBOT_DOF];
} robot_speed_cap;

/* Springs and dampers that hold the joints at an anchor, and slip beyond a force, N m or N. */
typedef struct {
    robot_real force[ROBOT_DOF], stiffness[ROBOT_DOF], damping[ROBOT_DOF];
} robot_hold;

/* The share of friction that is given back, at most 0.9, and the rate above which it is, rad/s or m/s. */
typedef struct {
    robot_real share, layer;
} robot_friction_compensation;

/* Diagonals of K_N, 1/s², and D_N, 1/s, of the null space of the task, and its posture. */
typedef struct {
    robot_real stiffness[ROBOT_DOF], damping[ROBOT_DOF], posture[ROBOT_DOF];
} robot_null_space;

typedef struct {
    robot_real damping[ROBOT_DOF];
    const robot_walls *walls;
    const robot_speed_cap *cap;
    const robot_hold *hold;
    const robot_friction_compensation *friction;
    const robot_real *torque_limits; /* ROBOT_DOF numbers */
} robot_hand_guiding_gains;

/* K by rows of ROBOT_TASK, N/m or N m/rad; the damping ratio, or in its place the diagonal of D, N s/m or N m s/rad. Directions
 * slower than slowest, 1/s, are taken as those of a singular posture; 0 for none. */
typedef struct {
    robot_real stiffness[ROBOT_TASK_ROWS], ratio;
    const robot_real *damping; /* ROBOT_TASK_ROWS numbers */
    robot_real slowest;
    const robot_null_space *null_space;
    const robot_friction_compensation *friction;
    const robot_real *torque_limits; /* ROBOT_DOF numbers */
} robot_impedance_gains;

/* tau = g(q) + friction in part - D dq + walls + cap + hold: a hand leads the arm. The anchor, rad or m, moves with the arm where the hold
 * slips; begin with the measured q. NULL without a hold. */
int robot_hand_guiding(
    const robot_hand_guiding_gains *gains, robot_real anchor[ROBOT_DOF], const robot_real q[ROBOT_DOF],
    const robot_real dq[ROBOT_DOF], robot_real tau[ROBOT_DOF]);

/* tau = g(q) + J' (K e + D de) + B ddq_r + C dq_r: the end effector is a spring and a damper about a frame in the base, with its
 * velocity and acceleration, linear then angular; NULL for those of a frame at rest. */
int robot_impedance(
    const robot_impedance_gains *gains, const robot_real frame[4][4], const robot_real velocity[6],
    const robot_real acceleration[6], const robot_real q[ROBOT_DOF], const robot_real dq[ROBOT_DOF], robot_real tau[ROBOT_DOF]);

#ifdef __cplusplus
}
#endif

#endif

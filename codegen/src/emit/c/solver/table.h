
/* Tables are where the functions are: on the device of CUDA and HIP, too. */
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
#define ROBOT_TABLE static __device__ const
#else
#define ROBOT_TABLE static const
#endif

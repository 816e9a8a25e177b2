#if defined(__GNUC__)
#define ROBOT_INLINE static inline __attribute__((always_inline))
#else
#define ROBOT_INLINE static inline
#endif


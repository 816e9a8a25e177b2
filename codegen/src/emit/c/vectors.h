#if defined(__GNUC__)
#define ROBOT_INLINE static inline __attribute__((always_inline))
#else
#define ROBOT_INLINE static inline
#endif

/* Where there are vectors, angles are filled up to whole vectors. */
#if defined(__SSE2__) || defined(__ARM_NEON) || defined(__wasm_simd128__) || defined(_M_X64)
#define ROBOT_ANGLES(used, filled) (filled)
#else
#define ROBOT_ANGLES(used, filled) (used)
#endif



/*
 * The integer part of x / (pi/2), of which the last three binary digits count, and what is left of x beyond it in two parts; x is the sum of
 * `count` parts of 24 bits, the first times 2^exponent. After Payne and Hanek (1983), as fdlibm (Sun Microsystems 1993) does it: of the digits
 * of 2/pi those that matter, `terms` + 1 words of them to begin with and more where they cancel.
 */
static inline int32_t robot_libm_large_angle(const double *x, int count, int exponent, int terms, double *rest)
{
    ROBOT_UNFUSED
    static const int32_t two_over_pi[66] = {
        0xA2F983, 0x6E4E44, 0x1529FC, 0x2757D1, 0xF534DD, 0xC0DB62, 0x95993C, 0x439041, 0xFE5163, 0xABDEBB, 0xC561B7, 0x246E3A,
        0x424DD2, 0xE00649, 0x2EEA09, 0xD1921C, 0xFE1DEB, 0x1CB129, 0xA73EE8, 0x8235F5, 0x2EBB44, 0x84E99C, 0x7026B4, 0x5F7E41,
        0x3991D6, 0x398353, 0x39F49C, 0x845F8B, 0xBDF928, 0x3B1FF8, 0x97FFDE, 0x05980F, 0xEF2F11, 0x8B5A0A, 0x6D1F6D, 0x367ECF,
        0x27CB09, 0xB74F46, 0x3F669E, 0x5FEA2D, 0x7527BA, 0xC7EBE5, 0xF17B3D, 0x0739F7, 0x8A5292, 0xEA6BFB, 0x5FB11F, 0x8D5D08,
        0x560330, 0x46FC7B, 0x6BABF0, 0xCFBC20, 0x9AF436, 0x1DA9E3, 0x91615E, 0xE61B08, 0x659985, 0x5F14A0, 0x68408D, 0xFFD880,
        0x4D7327, 0x310606, 0x1556CA, 0x73A8C9, 0x60E27B, 0xC08C6B};
    static const double half_pi[8] = {
        1.57079625129699707031e+00, 7.54978941586159635335e-08, 5.39030252995776476554e-15, 3.28200341580791294123e-22,
        1.27065575308067607349e-29, 1.22933308981111328932e-36, 2.73370053816464559624e-44, 2.16741683877804819444e-51};
    const double up = 16777216.0, down = 5.9604644775390625e-08;
    const int last = count - 1;
    const int first = exponent < 27 ? 0 : (exponent - 3) / 24;
    int scale = exponent - 24 * (first + 1), high = terms, half, i, j, k;
    double words[20], products[20], sums[20] = {0}, z, sum;
    int32_t digits[20], n, carry;
    for (i = 0; i <= last + terms; ++i) {
        j = first - last + i;
        words[i] = j < 0 ? 0.0 : (double)two_over_pi[j];
    }
    for (i = 0; i <= terms; ++i) {
        sum = 0;
        for (j = 0; j <= last; ++j) {
            sum += x[j] * words[last + i - j];
        }
        products[i] = sum;
    }
    for (;;) {
        /* The product's digits, the lowest first, and its integer part modulo 8. */
        z = products[high];
        for (i = 0, j = high; j > 0; ++i, --j) {
            sum = (double)(int32_t)(down * z);
            digits[i] = (int32_t)(z - up * sum);
            z = products[j - 1] + sum;
        }
        z = ldexp(z, scale);
        z -= 8.0 * floor(z * 0.125);
        n = (int32_t)z;
        z -= (double)n;
        half = 0;
        if (scale > 0) {
            i = digits[high - 1] >> (24 - scale);
            n += i;
            digits[high - 1] -= i << (24 - scale);
            half = digits[high - 1] >> (23 - scale);
        } else if (scale == 0) {
            half = digits[high - 1] >> 23;
        } else if (z >= 0.5) {
            half = 2;
        }
        if (half > 0) {
            /* Beyond a half: from the next integer back. */
            n += 1;
            carry = 0;
            for (i = 0; i < high; ++i) {
                if (carry != 0) {
                    digits[i] = 0xffffff - digits[i];
                } else if (digits[i] != 0) {
                    carry = 1;
                    digits[i] = 0x1000000 - digits[i];
                }
            }
            if (scale == 1) {
                digits[high - 1] &= 0x7fffff;
            } else if (scale == 2) {
                digits[high - 1] &= 0x3fffff;
            }
            if (half == 2) {
                z = 1.0 - z;
                if (carry != 0) {
                    z -= ldexp(1.0, scale);
                }
            }
        }
        if (z != 0) {
            break;
        }
        carry = 0;
        for (i = high - 1; i >= terms; --i) {
            carry |= digits[i];
        }
        if (carry != 0) {
            break;
        }
        /* All that there is has cancelled: more digits. */
        for (k = 1; digits[terms - k] == 0; ++k) {
        }
        for (i = high + 1; i <= high + k; ++i) {
            words[last + i] = (double)two_over_pi[first + i];
            sum = 0;
            for (j = 0; j <= last; ++j) {
                sum += x[j] * words[last + i - j];
            }
            products[i] = sum;
        }
        high += k;
    }
    if (z == 0) {
        do {
            high -= 1;
            scale -= 24;
        } while (digits[high] == 0);
    } else {
        z = ldexp(z, -scale);
        if (z >= up) {
            sum = (double)(int32_t)(down * z);
            digits[high] = (int32_t)(z - up * sum);
            high += 1;
            scale += 24;
            digits[high] = (int32_t)sum;
        } else {
            digits[high] = (int32_t)z;
        }
    }
    /* Times pi/2, from the smallest digits on. */
    sum = ldexp(1.0, scale);
    for (i = high; i >= 0; --i) {
        products[i] = sum * (double)digits[i];
        sum *= down;
    }
    for (i = high; i >= 0; --i) {
        sum = 0;
        for (k = 0; k <= terms && k <= high - i; ++k) {
            sum += half_pi[k] * products[i + k];
        }
        sums[high - i] = sum;
    }
    sum = 0;
    for (i = high; i >= 0; --i) {
        sum += sums[i];
    }
    rest[0] = half == 0 ? sum : -sum;
    sum = sums[0] - sum;
    for (i = 1; i <= high; ++i) {
        sum += sums[i];
    }
    rest[1] = half == 0 ? sum : -sum;
    return n & 7;
}

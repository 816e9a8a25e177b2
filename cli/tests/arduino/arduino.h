// Arduino as far as the sketches need it.
#include <stdint.h>
#include <stdio.h>
#include <string.h>

struct Port {
    void begin(long) {}
    void print(int x) { printf("%d", x); }
    void print(double x, int) { printf("%.9g", x); }
    void print(const char *text) { printf("%s", text); }
} Serial;
void delay(unsigned long) {}

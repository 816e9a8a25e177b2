// @MADE@
// Prints the torques that hold the arm at rest, once a second.
#include <@ROBOT@.h>

void setup()
{
    Serial.begin(115200);
}

void loop()
{
@GIVEN@    const @PREFIX@_real q[@UPPER@_DOF] = {0}; // rad, m
    @PREFIX@_real g[@UPPER@_DOF];             // N m, N
    @PREFIX@_gravity(@PASSED@q, g);
    for (int i = 0; i < @UPPER@_DOF; ++i) {
        Serial.print(g[i], 4);
        Serial.print(i + 1 < @UPPER@_DOF ? " " : "\n");
    }
    delay(1000);
}

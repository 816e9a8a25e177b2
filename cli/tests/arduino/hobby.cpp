// The sketch of docs/hobby-arm.md.
#include "arduino.h"
#include "hobby.ino"

int main()
{
    setup();
    loop();
    return 0;
}

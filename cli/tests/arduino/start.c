/* The Cortex-M4F of QEMU (mps2-an386), with the standard streams of the host (rdimon of newlib). */
extern void _start(void);
static void reset(void)
{
    *(volatile unsigned *)0xE000ED88 |= 0xFu << 20; /* the unit for floating point */
    _start();
}
__attribute__((section(".vectors"), used)) static void *const vectors[] = {(void *)0x20400000, (void *)reset};

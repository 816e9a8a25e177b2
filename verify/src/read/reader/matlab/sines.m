function [sine, cosine] = sinCos(x)
% Sines and cosines of angles, rad, each within 1 unit in the last place; those of |x| > 65536 are the ones of the library.
%
% n is the integer nearest to 2x/pi: adding 3/2 2^52 rounds.
% x = n pi/2 + r - e, after Cody and Waite (1980): pi/2 is a sum of three numbers, of which the first two have 37 bits. Their products
% with n are exact, and so is x less the first; e holds the third product less what r rounds away. p and q are minimax on
% |r| <= pi/4 (Remez). b is at first -n modulo 4, from -2 to 2, then minus the sine of n pi/2, of which a is the cosine: the theorems of addition
% are exact, as a product with 1 and a sum with 0 are, and s is 0 for x = 0 alone.
    n = (x .* 0.6366197723675814 + 6755399441055744.0) - 6755399441055744.0;
    first = x - n .* 1.5707963267923333;
    step = n .* 2.5633441515839558e-12;
    r = first - step;
    e = n .* 1.0562999066987428e-23 - ((first - r) - step);
    z = r .* r;
    zz = z .* z;
    half = 0.5 .* z;
    top = 1.0 - half;
    p = (0.1666666666666663 + z .* -0.008333333333322035) + zz .* ((0.00019841269829660063 + z .* -2.7557313668040543e-6) + zz .* (2.5050756282937577e-8 + z .* -1.5896732662311403e-10));
    s = r - (e .* top + (z .* r) .* p);
    q = (0.0416666666666666 + z .* -0.0013888888888873453) + zz .* ((2.4801587287964484e-5 + z .* -2.7557313594775254e-7) + zz .* (2.087558805713208e-9 + z .* -1.1351822784169523e-11));
    c = top + ((((1.0 - top) - half) + r .* e) + zz .* q);
    b = 4.0 .* ((n .* 0.25 + 6755399441055744.0) - 6755399441055744.0) - n;
    a = 1.0 - abs(b);
    b = b .* (1.0 + a);
    sine = s .* a - c .* b;
    cosine = c .* a + s .* b;
    if max(abs(x(:))) > 65536.0
        k = abs(x) > 65536.0;
        sine(k) = sin(x(k));
        cosine(k) = cos(x(k));
    end
end

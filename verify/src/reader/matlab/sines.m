function [sine, cosine] = sinCos(x)
% Sines and cosines of angles, rad, each within 1 unit in the last place; those of |x| > 65536 are the ones of the library.
%
% n is the integer nearest to 2x/pi: adding 3/2 2^52 rounds.
% x = n pi/2 + r - e, after Cody and Waite (1980): pi/2 is a sum of three numbers, of which the first two have 37 bits. Their products
% with n are exact, and so is x less the first; e holds the third product less what r rounds away. The polynomials are minimax on
% |r| <= pi/4 (Remez). h is n/2 rounded to the nearest even integer of the two where n is odd: n - 2h and h modulo 2 say which of the two is
% the sine, and the signs.
    n = (x .* 0.6366197723675814 + 6755399441055744.0) - 6755399441055744.0;
    first = x - n .* 1.5707963267923333;
    step = n .* 2.5633441515839558e-12;
    r = first - step;
    e = n .* 1.0562999066987428e-23 - ((first - r) - step);
    z = r .* r;
    zz = z .* z;
    p = (0.008333333333322035 + z .* -0.00019841269829660063) + zz .* ((2.7557313668040543e-6 + z .* -2.5050756282937577e-8) + zz .* 1.5896732662311403e-10);
    s = r - (e + (z .* r) .* (0.1666666666666663 - z .* p));
    q = (0.0416666666666666 + z .* -0.0013888888888873453) + zz .* ((2.4801587287964484e-5 + z .* -2.7557313594775254e-7) + zz .* (2.087558805713208e-9 + z .* -1.1351822784169523e-11));
    half = 0.5 .* z;
    top = 1.0 - half;
    c = top + (((1.0 - top) - half) + (zz .* q + r .* e));
    h = (n .* 0.5 + 6755399441055744.0) - 6755399441055744.0;
    odd = n - 2.0 .* h;
    two = h - 2.0 .* ((h .* 0.5 + 6755399441055744.0) - 6755399441055744.0);
    flip = 1.0 - (two + two) .* two;
    k = odd ~= 0.0;
    flip(k) = odd(k);
    sine = s;
    sine(k) = c(k);
    sine = sine .* flip;
    cosine = c;
    cosine(k) = -s(k);
    cosine = cosine .* flip;
    k = ~(x .* x <= 4294967296.0);
    sine(k) = sin(x(k));
    cosine(k) = cos(x(k));
end

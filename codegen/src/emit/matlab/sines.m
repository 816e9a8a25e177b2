function [sine, cosine] = sinCos(x)
% Sines and cosines of angles, rad, each within 1 unit in the last place; those of |x| > @limit@ are the ones of the library.
%
% @sines@
    n = (x .* @two_over_pi@ + @round@) - @round@;
    first = x - n .* @first@;
    step = n .* @second@;
    r = first - step;
    e = n .* @third@ - ((first - r) - step);
    z = r .* r;
    zz = z .* z;
    p = @sine@;
    s = r - (e + (z .* r) .* (@sixth@ - z .* p));
    q = @cosine@;
    half = 0.5 .* z;
    top = 1.0 - half;
    c = top + (((1.0 - top) - half) + (zz .* q + r .* e));
    h = (n .* 0.5 + @round@) - @round@;
    odd = n - 2.0 .* h;
    two = h - 2.0 .* ((h .* 0.5 + @round@) - @round@);
    flip = 1.0 - (two + two) .* two;
    k = odd ~= 0.0;
    flip(k) = odd(k);
    sine = s;
    sine(k) = c(k);
    sine = sine .* flip;
    cosine = c;
    cosine(k) = -s(k);
    cosine = cosine .* flip;
    k = ~(x .* x <= @square@);
    sine(k) = sin(x(k));
    cosine(k) = cos(x(k));
end

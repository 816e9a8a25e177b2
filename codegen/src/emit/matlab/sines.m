function [sine, cosine] = sinCos(x)
% Sines and cosines of angles, rad, each within 1 unit in the last place; those of |x| > @limit@ are the ones of the library.
%
% @sines_of_arrays@
    n = (x .* @two_over_pi@ + @round@) - @round@;
    first = x - n .* @first@;
    step = n .* @second@;
    r = first - step;
    e = n .* @third@ - ((first - r) - step);
    z = r .* r;
    zz = z .* z;
    half = 0.5 .* z;
    top = 1.0 - half;
    p = @sine@;
    s = r - (e .* top + (z .* r) .* p);
    q = @cosine@;
    c = top + ((((1.0 - top) - half) + r .* e) + zz .* q);
    b = 4.0 .* ((n .* 0.25 + @round@) - @round@) - n;
    a = 1.0 - abs(b);
    b = b .* (1.0 + a);
    sine = s .* a - c .* b;
    cosine = c .* a + s .* b;
    if max(abs(x(:))) > @limit@.0
        k = abs(x) > @limit@.0;
        sine(k) = sin(x(k));
        cosine(k) = cos(x(k));
    end
end

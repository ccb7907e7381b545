#!/usr/bin/python3
# simp.py with its design written down after every iteration, and a bridge: simp_trace.py CASE CELLS MAXIT FILE
# A line "iteration objective seconds states columns rows", then the nodal field row by row from the bottom; writing costs no time.
import sys, time
import numpy as np
import cases

e = 1e-9
cases.CASES["bridge"] = dict(w=2.0, h=1.0, hole=None, load=("bottom", 0.1, 1.9), sup=[(lambda x, y: (y < e) & ((x < 0.1+e) | (x > 1.9-e)), 1, 1)], vol=0.4)
onload = cases.onload
cases.onload = lambda c, x, y: (abs(y) < e) & (x > c["load"][1]-e) & (x < c["load"][2]+e) if c["load"][0] == "bottom" else onload(c, x, y)


def cut(text, mark):
    parts = text.split(mark)
    if len(parts) != 2: sys.exit("simp.py has changed: no single %r" % mark)
    return parts


source = open("simp.py").read()
loop, rest = cut(source, "    if ch < 0.01: break\n")
field, end = cut(rest, "np.savez(")
if sys.argv[1] == "bridge":                                 # the deck stays: one more condition on the densities
    bound = "np.minimum(1, x+.2))*act"
    before, after = cut(loop, bound)
    loop = before + bound + "; xn[yc < 0.05] = 1" + after
loop, start = loop.replace("time.process_time()", "clock()"), time.process_time()
lost, out = 0.0, open(sys.argv[4], "w")
clock = lambda: time.process_time() - lost


def trace():
    global lost
    t = time.process_time()
    exec(field, scope)
    f = scope["f"]
    out.write("%d %.9g %.6g %d %d %d\n" % (scope["it"], scope["Jc"], t-lost-scope["t0"], scope["it"], f.shape[1], f.shape[0]))
    np.savetxt(out, -f, fmt="%.5g")
    out.flush()
    lost += time.process_time() - t


sys.argv = ["simp.py", sys.argv[1], sys.argv[2], sys.argv[3], "simp.npz"]
scope = dict(clock=clock, trace=trace)
exec(loop + "    trace()\n    if ch < 0.01: break\n", scope)
print("done", scope["it"])

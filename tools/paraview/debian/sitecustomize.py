# Debian's ParaView 5.11 asks Python 3.11 for a function that it no longer has, and so loads no Python plugin without this line.
import inspect; inspect.getargspec = getattr(inspect, "getargspec", inspect.getfullargspec)  # fmt: skip

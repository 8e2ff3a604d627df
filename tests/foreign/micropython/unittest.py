# As much of unittest as MicroPython's own tests use, with the summary that its runner reads. The library that has it
# is not in Debian's source package.


class Raises:
    def __init__(self, kind):
        self.kind = kind
        self.exception = None

    def __enter__(self):
        return self

    def __exit__(self, kind, value, trace):
        assert kind is not None, "%r not raised" % self.kind
        self.exception = value
        return issubclass(kind, self.kind)


class TestCase:
    def assertEqual(self, left, right):
        assert left == right, "%r, not %r" % (left, right)

    def assertIn(self, part, whole):
        assert part in whole, "%r is not in %r" % (part, whole)

    def assertIsInstance(self, value, kind):
        assert isinstance(value, kind), "%r is no %r" % (value, kind)

    def assertRaises(self, kind):
        return Raises(kind)


class SkipTest(Exception):
    pass


def skipIf(condition, reason):
    def skipped(case):
        raise SkipTest(reason)

    return lambda test: skipped if condition else test


def run_test(case, name):
    """One of ok, skipped, FAIL and ERROR, said and returned."""
    getattr(case, "setUp", str)()
    verdict, why = "ok", ""
    try:
        getattr(case, name)()
    except SkipTest as error:
        verdict, why = "skipped", error
    except AssertionError as error:
        verdict, why = "FAIL", error
    except Exception as error:
        verdict, why = "ERROR", repr(error)
    getattr(case, "tearDown", str)()
    print(name, verdict, why)
    return verdict


def main():
    module = __import__("__main__")
    verdicts = []
    for kind in [getattr(module, name) for name in sorted(dir(module))]:
        if isinstance(kind, type) and issubclass(kind, TestCase):
            case = kind()
            getattr(case, "setUpClass", str)()
            verdicts += [run_test(case, name) for name in sorted(dir(case)) if name.startswith("test")]
    skipped, failures, errors = [verdicts.count(verdict) for verdict in ("skipped", "FAIL", "ERROR")]
    print("-" * 70)
    print("Ran %d tests\n" % len(verdicts))
    if failures + errors:
        print("FAILED (failures=%d, errors=%d)" % (failures, errors))
    else:
        print("OK (skipped=%d)" % skipped if skipped else "OK")

"""`python -m axisrig.bench.cli`."""

from axisrig.bench.cli.main import main

if __name__ == "__main__":
    main()

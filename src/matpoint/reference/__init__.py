"""Reference solutions that owe nothing to the particle methods: finite elements, modes, closed forms."""

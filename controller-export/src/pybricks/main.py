if __name__ == "__main__":
    try:
        print(run(Robot()))
    except Missing as missing:
        print(missing)
